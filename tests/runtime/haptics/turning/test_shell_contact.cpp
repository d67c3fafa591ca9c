// SPDX-License-Identifier: Apache-2.0
// A whole tool that turns, as points against distance fields of rigid bodies.
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

#include "formats/model/arrays.hpp"
#include "formats/model/errors.hpp"
#include "runtime/haptics/shell/shell_equilibrium.hpp"
#include "runtime/haptics/whole_tool/rod.hpp"
#include "tests/runtime/haptics/held_tool.hpp"
#include "tests/runtime/haptics/turning/turned_tool.hpp"

namespace palpate {
namespace {

using namespace haptics;
using Eigen::Quaterniond;
using Eigen::Vector3d;

TEST(Shell, a_face_on_a_plate_is_pushed_back_along_its_normal_without_torque) {
    HapticModel model(plate_and_bar(), "shell");
    const TickResult result = rest_at(model, turned_at({0, 0, -2}, Quaterniond::Identity()));
    EXPECT_EQ(result.status, tick_ok);
    EXPECT_EQ(result.body, 0);
    EXPECT_NEAR(result.depth, 2, 0.01);
    // What the points give way is little against the coupling's 2 mm.
    EXPECT_LT(result.residual, 0.02);
    EXPECT_NEAR(force_of(result).z(), coupling * (2 - result.residual), 1e-3);
    EXPECT_LT(force_of(result).head<2>().norm(), 1e-3);
    EXPECT_LT(torque_of(result).norm(), 0.1);  // points are not symmetric about the axis
}

TEST(Shell, a_bar_that_touches_with_its_far_end_turns_and_gives_the_torque_of_its_lever) {
    // It lies along x, its far edge 39 or 40 mm from the tip, over the plate's rim at x = 20: held 3 mm
    // lower.
    HapticModel model(plate_and_bar(), "shell");
    const Quaterniond lying = about(Vector3d::UnitY(), -90);  // shaft along -x
    const Vector3d tip(50, 0, -2);                            // beyond the plate; from x = 20 on it is above
    const TickResult result = rest_at(model, turned_at(tip, lying), 5);
    EXPECT_GT(force_of(result).z(), 0.1);
    EXPECT_GT(result.contact_count, 0);
    // Balance of moments about the tool's tip: kappa theta = sum r x f, with all of the force at the rim.
    const Vector3d rim(20, 0, 0), arm = rim - tool_of(result);
    const double tolerance = 0.03 * torque_of(result).norm();  // voxels round the rim: 0.9 mm of 30
    EXPECT_NEAR(torque_of(result).y(), arm.cross(force_of(result)).y(), tolerance);
    EXPECT_LT(std::abs(torque_of(result).x()), tolerance);
    const Quaterniond tool = quaternion_of(result.tool_orientation);
    EXPECT_NEAR(ToolSettings{}.torsional_stiffness * rotation_between(lying, tool).norm(),
                torque_of(result).norm(), 1e-6);
}

TEST(Shell, forces_are_those_of_its_touches) {
    Case c = plate();
    c.tool = bar();
    const collision::CollisionSurface surface(c.rigid_bodies[0].surface, c.rigid_bodies[0].obb_tree, "plate");
    std::vector<collision::DistanceField> fields;
    fields.emplace_back(surface, 0.5, 2, 1);
    const auto shell = collision::point_shell(c.tool->surface, 1000);
    ShellWatch watch(shell.points, fields, 0.25);
    const ToolPose device{{5, 3, -1}, about(Vector3d(1, 2, 0.5).normalized(), 25)};
    ToolPose pose{{5, 3, 8}, device.orientation};
    ToolRest rest = ToolRest::on_its_way;
    for (int tick = 0; tick < 20 && rest == ToolRest::on_its_way; ++tick)
        rest = bring_to_rest(watch, {device, coupling, 450}, 10, 0.25, pose);
    ASSERT_EQ(rest, ToolRest::settled);
    ASSERT_TRUE(watch.touches());
    Vector3d force = Vector3d::Zero(), moment = Vector3d::Zero();
    for (const ToolTouch& touch : watch.close()) {
        const Vector3d f = -10 * std::min(touch.distance, 0.0) * touch.gradient();
        force += f;
        moment += touch.arm.cross(f);
    }
    // What the search leaves out that ends at steps of 1e-5 mm.
    EXPECT_NEAR((force - coupling * (pose.position - device.position)).norm(), 0, 1e-4);
    EXPECT_NEAR((moment - 450 * rotation_between(device.orientation, pose.orientation)).norm(), 0, 1e-2);
}

TEST(Shell, skipping_points_that_are_clear_misses_no_touch) {
    const Case c = plate_and_bar();
    const collision::CollisionSurface surface(c.rigid_bodies[0].surface, c.rigid_bodies[0].obb_tree, "plate");
    std::vector<collision::DistanceField> fields;
    fields.emplace_back(surface, 0.5, 2, 1);
    const auto shell = collision::point_shell(c.tool->surface, 500);
    constexpr double close = 0.25;  // mm
    ShellWatch watch(shell.points, fields, close);
    std::mt19937 random(3);
    std::normal_distribution<double> step(0, 1);
    ToolPose pose{{0, 0, 4}, Quaterniond::Identity()};
    std::size_t touched = 0;
    for (int k = 0; k < 10'000; ++k) {
        Twist motion;
        for (double& x : motion) x = step(random);
        motion.head<3>() *= 0.2;
        motion.tail<3>() *= 0.02;
        motion[2] -= 0.05 * pose.position.z();  // towards the plate's top
        pose = moved(pose, motion);
        watch.look(pose);
        std::vector<std::int32_t> inside, seen;
        const Eigen::Matrix3d R = pose.orientation.toRotationMatrix();
        for (std::size_t i = 0; i < shell.points.size(); ++i)
            if (fields[0].at(pose.position + R * shell.points[i].position.cast<double>()).distance < close)
                inside.push_back(static_cast<std::int32_t>(i));
        for (const ToolTouch& touch : watch.close()) seen.push_back(touch.point);
        ASSERT_EQ(seen, inside) << "pose " << k;
        touched += inside.size();
    }
    EXPECT_GT(touched, 10'000u);
}

TEST(Shell, a_closed_loop_of_position_and_orientation_gives_no_energy) {
    HapticModel model(plate_and_bar(), "shell");
    const Loop loop = work_of_loop(model, 450);
    EXPECT_GT(loop.stored, 0.3);
    EXPECT_LT(std::abs(loop.work), 0.01 * loop.stored);
}

TEST(Shell, a_tool_that_begins_inside_feels_nothing_until_it_has_been_clear) {
    HapticModel model(plate_and_bar(), "shell");
    TickResult result{};
    model.tick(turned_at({0, 0, -1}, Quaterniond::Identity()), result);
    EXPECT_TRUE(result.status & starts_inside);
    EXPECT_EQ(force_of(result).norm(), 0);
    model.tick(turned_at({0, 0, 1}, Quaterniond::Identity()), result);
    EXPECT_EQ(result.status, tick_ok);
    EXPECT_GT(force_of(rest_at(model, turned_at({0, 0, -1}, Quaterniond::Identity()), 2)).z(), 0.1);
}

TEST(Shell, a_fast_tool_does_not_pass_through_a_plate) {
    HapticModel model(plate_and_bar(), "shell");
    TickResult result{};
    for (int tick = 0; tick < 40; ++tick)  // 1 m/s, down to 30 mm below the top of a plate 10 mm thick
        model.tick(turned_at({0, 0, std::max(5.0 - tick, -30.0)}, Quaterniond::Identity()), result);
    EXPECT_GT(tool_of(result).z(), -1);
    EXPECT_GT(force_of(result).z(), 10);
}

TEST(Shell, without_a_body_of_its_own_the_tool_is_the_cases_ball) {
    HapticModel model(plate(), "shell");
    EXPECT_EQ(model.contact_radius(), 1);
    const TickResult result = rest_at(model, held_at({0, 0, 0}));
    EXPECT_NEAR(force_of(result).z(), coupling * 1, 0.05);
}

TEST(Shell, refuses_a_case_without_rigid_bodies_and_settings_that_make_no_sense) {
    EXPECT_THROW(HapticModel(soft_cube(2), "shell"), InvalidInput);
    Case c = plate_and_bar();
    c.tool->settings.voxel = 0;
    try {
        HapticModel(c, "shell");
        FAIL() << "taken";
    } catch (const InvalidInput& error) {
        EXPECT_EQ(error.detail().culprit, "--voxel");
    }
}

TEST(Shell, a_rod_is_closed_and_as_long_as_asked) {
    constexpr double volume_cut = 0.04, area_cut = 0.03;  // by 24 corners around and 12 rings over the balls
    for (const double length : {0.0, 30.0}) {
        const TriangleMesh rod = rod_surface(2, length);
        double volume = 0;
        for (const Triangle& t : rod.triangles)
            volume += rod.vertices[t[0]].dot(rod.vertices[t[1]].cross(rod.vertices[t[2]])) / 6;
        const double exact = std::numbers::pi * 4 * (8.0 / 3 + length);
        EXPECT_NEAR(volume, exact, volume_cut * exact) << length;
        double area = 0;
        for (const Triangle& t : rod.triangles)
            area += (rod.vertices[t[1]] - rod.vertices[t[0]])
                        .cross(rod.vertices[t[2]] - rod.vertices[t[0]])
                        .norm() /
                    2;
        const double exact_area = 4 * std::numbers::pi * (4 + length);
        EXPECT_NEAR(area, exact_area, area_cut * exact_area) << length;
    }
}

}  // namespace
}  // namespace palpate
