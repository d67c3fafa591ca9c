// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <vector>

#include "runtime/haptics/haptic_model.hpp"
#include "runtime/session/clear_hold.hpp"
#include "tests/formats/sample_case.hpp"

namespace palpate {
namespace {

using namespace session;
using Eigen::Vector3d;

// The skull's sphere of 15 mm about (40, 10, 10) beside the wall's cube [0, 20]³, and a rod of 1.5 mm radius.
class ClearHold : public ::testing::Test {
  protected:
    static Case case_with_rod(double length) {
        Case patient_case = sample::sample_case(4);
        patient_case.tool.emplace();
        patient_case.tool->settings.rod_length = length;
        return patient_case;
    }
    Vector3d shaft(const Vector3d& tip, const Vector3d& normal, std::optional<Vector3d> eye = {}) const {
        return clear_hold(patient_case_, surfaces_, tip, normal, eye) * Vector3d::UnitZ();
    }

    const Case patient_case_ = case_with_rod(60);
    const haptics::HapticModel model_{patient_case_};
    const std::vector<const collision::CollisionSurface*> surfaces_{&model_.surface(0), &model_.surface(1)};
    const double radius_ = patient_case_.haptics.tool_radius;
};

TEST_F(ClearHold, is_the_normal_where_nothing_is_in_the_way) {
    EXPECT_LT((shaft({10, 10, 23}, Vector3d::UnitZ()) - Vector3d::UnitZ()).norm(), 1e-12);
}

TEST_F(ClearHold, goes_past_what_is_in_the_way_as_near_to_the_normal_as_it_can) {
    const Vector3d tip(22, 10, 10), middle(40, 10, 10), normal = Vector3d::UnitX();
    const Vector3d way = shaft(tip, normal);
    double nearest = 1e9;
    for (double along = 0; along <= 60; along += 0.1)
        nearest = std::min(nearest, (tip + along * way - middle).norm());
    constexpr double facets = 0.3;  // mm, of the sphere's triangles
    EXPECT_GT(nearest, 15 - facets + radius_);
    const double least_angle = std::asin((15 + radius_) / (middle - tip).norm());
    constexpr double apart = 5 * std::numbers::pi / 180;
    EXPECT_LT(std::acos(way.dot(normal)), least_angle + apart);
}

TEST_F(ClearHold, keeps_clear_of_the_eye) {
    const Vector3d tip(10, 10, 23), eye(10, 11, 60);
    const Vector3d way = shaft(tip, Vector3d::UnitZ(), eye);
    EXPECT_GE((eye - tip).cross(way).norm(), radius_ + 4);
    EXPECT_GT(way.z(), 0.95);
}

TEST_F(ClearHold, where_something_is_in_every_way_it_goes_to_what_is_farthest) {
    // In the sphere, 5 mm off its middle: 20 mm from its other side and less from all others.
    const Vector3d way = shaft({45, 10, 10}, Vector3d::UnitZ());
    EXPECT_LT(way.x(), -0.98);
}

}  // namespace
}  // namespace palpate
