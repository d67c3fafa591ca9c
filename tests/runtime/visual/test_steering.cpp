// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <gtest/gtest.h>
#include <numbers>
#include <vtkCamera.h>
#include <vtkNew.h>

#include "runtime/visual/hand/pointer_hand.hpp"
#include "runtime/visual/hand/steering.hpp"

namespace palpate {
namespace {

using namespace visual;
using Eigen::Quaterniond;
using Eigen::Vector3d;

// An eye at the end of z that has x on its right and y up, and a tool whose shaft comes towards it.
class Tilting : public testing::Test {
  protected:
    Tilting() {
        camera->SetPosition(0, 0, 100);
        camera->SetFocalPoint(0, 0, 0);
        camera->SetViewUp(0, 1, 0);
    }
    Steering steering(std::optional<Vector3d> tip = {}) {
        return {hand, camera, 720, std::nullopt, tip, &orientation};
    }
    Vector3d shaft() const { return orientation * Vector3d::UnitZ(); }

    vtkNew<vtkCamera> camera;
    PointerHand hand{Vector3d::Zero(), 2};
    Quaterniond orientation = Quaterniond::Identity();
};

constexpr double step = 5 * std::numbers::pi / 180;

TEST_F(Tilting, a_key_takes_the_handle_to_its_side) {
    tilt_tool(steering(), "Right");
    EXPECT_LT((shaft() - Vector3d(std::sin(step), 0, std::cos(step))).norm(), 1e-12);
    tilt_tool(steering(), "Left");
    tilt_tool(steering(), "Up");
    EXPECT_LT((shaft() - Vector3d(0, std::sin(step), std::cos(step))).norm(), 1e-12);
    tilt_tool(steering(), "Down");
    EXPECT_LT(orientation.angularDistance(Quaterniond::Identity()), 1e-9);
    EXPECT_EQ(hand.place(), Vector3d::Zero());
}

TEST_F(Tilting, seen_from_the_tip_a_key_says_where_it_looks) {
    tilt_tool(steering(Vector3d::Zero()), "Right");
    EXPECT_LT((-shaft() - Vector3d(std::sin(step), 0, -std::cos(step))).norm(), 1e-12);
    orientation.setIdentity();
    tilt_tool(steering(Vector3d::Zero()), "Up");
    EXPECT_LT((-shaft() - Vector3d(0, std::sin(step), -std::cos(step))).norm(), 1e-12);
}

TEST_F(Tilting, rolls_about_the_shaft_however_that_lies) {
    tilt_tool(steering(), "Right");
    const Quaterniond before = orientation;
    tilt_tool(steering(), "w");
    EXPECT_LT((shaft() - before * Vector3d::UnitZ()).norm(), 1e-12);
    EXPECT_NEAR(orientation.angularDistance(before), step, 1e-9);
    tilt_tool(steering(), "s");
    EXPECT_LT(orientation.angularDistance(before), 1e-9);
}

TEST_F(Tilting, a_drag_takes_the_handle_along) {
    tilt_tool(steering(), 20, 0);
    EXPECT_GT(shaft().x(), 0.1);
    EXPECT_NEAR(shaft().y(), 0, 1e-12);
    tilt_tool(steering(), -20, 20);
    EXPECT_GT(shaft().y(), 0.1);
}

TEST_F(Tilting, what_does_not_turn_stays) {
    Steering ball = steering();
    ball.orientation = nullptr;
    tilt_tool(ball, "Right");
    tilt_tool(ball, 20, 0);
    EXPECT_EQ(orientation.coeffs(), Quaterniond::Identity().coeffs());
}

}  // namespace
}  // namespace palpate
