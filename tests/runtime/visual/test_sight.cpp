// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "runtime/visual/sight.hpp"
#include "tests/formats/sample_case.hpp"

namespace palpate {
namespace {

using namespace visual;

// The sample's elastic cube fills [0, 20]³ mm.
const Eigen::Vector3d on_top(10, 10, 20), upwards(0, 0, 1);

TEST(Sight, looks_down_the_normal_but_past_the_tool) {
    const Case patient_case = sample::sample_case();
    for (const Eigen::Vector3d& normal : {upwards, Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, -1, 0),
                                          Eigen::Vector3d(0, 0, -1), Eigen::Vector3d(1, 1, 1).normalized()}) {
        const Sight sight = choose_sight(patient_case, on_top, normal);
        EXPECT_NEAR(sight.toward_eye.norm(), 1, 1e-12);
        const double angle = std::acos(sight.toward_eye.dot(normal)) * 180 / std::numbers::pi;
        EXPECT_GT(angle, 20);
        EXPECT_LT(angle, 50);
    }
}

TEST(Sight, eye_is_where_the_field_fills_the_view_angle) {
    const Sight sight = choose_sight(sample::sample_case(), on_top, upwards);
    const double distance = (sight.eye() - sight.focus).norm();
    EXPECT_NEAR(2 * distance * std::tan(sight.view_angle_deg * std::numbers::pi / 360), sight.field, 1e-9);
}

TEST(Sight, a_free_surface_is_not_blocked) {
    EXPECT_FALSE(choose_sight(sample::sample_case(), on_top, upwards).blocked);
}

TEST(Sight, a_body_around_the_target_blocks_it) {
    Case patient_case = sample::sample_case();
    patient_case.rigid_bodies.front().surface = sample::sphere_surface({10, 10, 10}, 60, 3);
    EXPECT_TRUE(choose_sight(patient_case, on_top, upwards).blocked);
}

TEST(Sight, the_deformable_body_itself_can_block) {
    // From the floor of the cube, looking in.
    EXPECT_TRUE(choose_sight(sample::sample_case(), {10, 10, 0}, upwards).blocked);
}

TEST(Sight, a_case_of_rigid_bodies_only_has_a_sight) {
    Case patient_case = sample::sample_case();
    patient_case.deformable_bodies.clear();
    const Sight sight = choose_sight(patient_case, {40, 10, 25}, upwards);
    EXPECT_GT(sight.field, 10);
    EXPECT_FALSE(sight.blocked);
}

}  // namespace
}  // namespace palpate
