// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "runtime/session/touch_target.hpp"
#include "tests/formats/sample_case.hpp"

namespace palpate {
namespace {

using namespace session;
using Eigen::Vector3d;

// The skull's sphere of 15 mm about (40, 10, 10); the wall's cube [0, 20]³, held at z = 0. Tool of 1.5 mm.
class TouchTargetTest : public ::testing::Test {
  protected:
    const Case patient_case_ = sample::sample_case(4);
    const haptics::HapticModel model_{patient_case_};
    TouchTarget choose(const std::string& body = "", std::optional<Vector3d> near = std::nullopt) const {
        return choose_touch_target(patient_case_, model_, body, near);
    }
};

TEST_F(TouchTargetTest, takes_the_most_compliant_place_of_the_first_deformable_body) {
    const TouchTarget target = choose();
    EXPECT_EQ(model_.body_name(target.body), "wall");
    EXPECT_EQ(target.place.point.z(), 20);
    EXPECT_EQ(target.place.normal, Vector3d(0, 0, 1));
    EXPECT_EQ(target.place.clearance, 5);
    EXPECT_NEAR(target.place.tangent.dot(target.place.normal), 0, 1e-12);
}

TEST_F(TouchTargetTest, finds_the_point_nearest_to_a_wish) {
    const TouchTarget target = choose("skull", Vector3d(40, 10, 100));
    EXPECT_EQ(model_.body_name(target.body), "skull");
    EXPECT_NEAR((target.place.point - Vector3d(40, 10, 25)).norm(), 0, 0.3);
}

TEST_F(TouchTargetTest, backs_out_only_as_far_as_other_surfaces_let_it) {
    // Between the cube's side at x = 20 and the sphere at x = 25 there are 5 mm; the tool takes 3 of them.
    const TouchTarget target = choose("wall", Vector3d(20.5, 10.2, 10.1));
    EXPECT_EQ(target.place.normal, Vector3d(1, 0, 0));
    EXPECT_NEAR(target.place.clearance, 2, 0.1);
}

TEST_F(TouchTargetTest, refuses_names_and_places_that_are_none) {
    EXPECT_THROW(choose("wal"), UsageError);
    Case narrow = patient_case_;
    narrow.haptics.tool_radius = 2.6;
    const haptics::HapticModel model(narrow);
    EXPECT_THROW(choose_touch_target(narrow, model, "wall", Vector3d(20.5, 10.2, 10.1)), InvalidInput);
}

}  // namespace
}  // namespace palpate
