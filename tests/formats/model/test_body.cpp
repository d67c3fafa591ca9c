// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "tests/formats/sample_case.hpp"

namespace palpate {
namespace {

TEST(Relaxation, of_a_region_is_its_own_terms_in_their_order) {
    DeformableBody body;
    body.relaxation = {{1, {0.3, 0.5}}, {1, {0.2, 4}}, {2, {0.1, 1}}};
    const auto terms = relaxation_of(body, 1);
    ASSERT_EQ(terms.size(), 2U);
    EXPECT_EQ(terms[0].share, 0.3);
    EXPECT_EQ(terms[1].time, 4);
    EXPECT_TRUE(relaxation_of(body, 3).empty());
}

TEST(Tool, is_a_ball_or_rod_of_the_settings_until_another_is_chosen) {
    Case patient_case;
    patient_case.haptics.tool_radius = 1.5;
    patient_case.haptics.shaft_length = 40;
    EXPECT_FALSE(has_instrument(patient_case));
    EXPECT_EQ(rod_length(patient_case), 40);
    EXPECT_EQ(tip_reach(patient_case), 1.5);
    patient_case.tool.emplace();
    EXPECT_FALSE(has_instrument(patient_case));
    EXPECT_EQ(rod_length(patient_case), 40);
    patient_case.tool->settings.rod_length = 60;
    EXPECT_EQ(rod_length(patient_case), 60);
}

TEST(Tool, with_a_surface_reaches_as_far_as_its_lowest_vertex) {
    Case patient_case;
    patient_case.haptics.tool_radius = 1.5;
    patient_case.tool.emplace();
    patient_case.tool->surface = sample::sphere_surface({0, 0, 5}, 8, 1);  // an octahedron's corners stay
    EXPECT_TRUE(has_instrument(patient_case));
    EXPECT_EQ(tip_reach(patient_case), 3);
}

}  // namespace
}  // namespace palpate
