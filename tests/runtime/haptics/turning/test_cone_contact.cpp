// SPDX-License-Identifier: Apache-2.0
// A whole tool that turns, pushed off by local minima of its distance from rigid bodies.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "formats/model/arrays.hpp"
#include "formats/model/errors.hpp"
#include "runtime/collision/features/split_edges.hpp"
#include "runtime/haptics/methods/cone_contact.hpp"
#include "tests/runtime/allocation_trap.hpp"
#include "tests/runtime/haptics/held_tool.hpp"
#include "tests/runtime/haptics/turning/turned_tool.hpp"

namespace palpate {
namespace {

using namespace haptics;
using Eigen::Quaterniond;
using Eigen::Vector3d;

// Of plate_and_bar(): 99 N at most on 100 N/mm.
constexpr double reach = 0.99;  // mm

double lowest_of_bar(const TickResult& result) {
    double lowest = std::numeric_limits<double>::infinity();
    for (const Vector3d& corner : bar().surface.vertices)
        lowest = std::min(lowest, (tool_of(result) + quaternion_of(result.tool_orientation) * corner).z());
    return lowest;
}

TEST(Cones, a_face_over_a_plate_is_pushed_back_along_its_normal_before_it_meets_it) {
    HapticModel model(plate_and_bar(), "cones");
    const TickResult result = rest_at(model, turned_at({0, 0, -2}, Quaterniond::Identity()));
    EXPECT_EQ(result.status, tick_ok);
    EXPECT_EQ(result.body, 0);
    const double gap = tool_of(result).z();
    EXPECT_GT(gap, 0);
    EXPECT_LT(gap, reach);
    EXPECT_NEAR(force_of(result).z(), coupling * (2 + gap), 1e-6);
    EXPECT_LT(force_of(result).head<2>().norm(), 1e-3);
    EXPECT_LT(torque_of(result).norm(), 0.1);
    EXPECT_EQ(result.residual, 0);
}

TEST(Cones, forces_and_moments_are_those_of_its_minima) {
    const Case c = plate_and_bar();
    const collision::SurfaceFeatures tool(c.tool->surface.vertices, c.tool->surface.triangles);
    const collision::NormalConeTree tree(tool);
    const std::vector<collision::SurfaceFeatures> features{
        {c.rigid_bodies[0].surface.vertices, c.rigid_bodies[0].surface.triangles}};
    const std::vector<collision::NormalConeTree> trees{collision::NormalConeTree(features[0])};
    HapticModel model(c, "cones");
    const ToolPose device{{5, 3, -1}, about(Vector3d(1, 2, 0.5).normalized(), 25)};
    const TickResult result = rest_at(model, turned_at(device.position, device.orientation), 8);
    ConeWatch watch(tree, trees, reach);
    watch.look({tool_of(result), quaternion_of(result.tool_orientation)});
    ASSERT_FALSE(watch.close().empty());
    Vector3d force = Vector3d::Zero(), moment = Vector3d::Zero();
    for (const ToolTouch& touch : watch.close()) {
        const Vector3d f = -100 * touch.distance * touch.gradient();
        EXPECT_NEAR(touch.gradient().norm(), 1, 1e-12);
        force += f;
        moment += touch.arm.cross(f);
    }
    EXPECT_NEAR((force - force_of(result)).norm(), 0, 2e-3);
    EXPECT_NEAR((moment - torque_of(result)).norm(), 0, 2e-2);
    EXPECT_GT(torque_of(result).norm(), 1);
}

TEST(Cones, what_is_kept_while_the_tool_moves_a_little_is_all_there_is) {
    const Case c = plate_and_bar();
    const TriangleMesh fine = collision::split_long_edges(c.tool->surface, 2, 5000);
    const collision::SurfaceFeatures tool(fine.vertices, fine.triangles);
    const collision::NormalConeTree tree(tool);
    const TriangleMesh ball = sample::sphere_surface({0, 0, 0}, 15, 3);
    const std::vector<collision::SurfaceFeatures> features{{ball.vertices, ball.triangles}};
    const std::vector<collision::NormalConeTree> trees{collision::NormalConeTree(features[0])};
    ConeWatch kept(tree, trees, 2);
    std::mt19937 random(3);
    std::normal_distribution<double> step(0, 1);
    ToolPose pose{{16, 0, 0}, about(Vector3d(1, 2, 0.5).normalized(), 60)};
    std::size_t found = 0;
    for (int k = 0; k < 3000; ++k) {
        Twist motion;
        for (double& x : motion) x = step(random);
        motion.head<3>() *= 0.05;
        motion.tail<3>() *= 0.003;
        motion.head<3>() -= 0.02 * (pose.position.norm() - 16) * pose.position.normalized();
        pose = moved(pose, motion);
        kept.look(pose);
        ConeWatch anew(tree, trees, 2);
        anew.look(pose);
        const auto distances = [](const ConeWatch& watch) {
            std::vector<double> all;
            for (const ToolTouch& touch : watch.close()) all.push_back(touch.distance);
            return all;
        };
        ASSERT_EQ(distances(kept), distances(anew)) << k;
        found += kept.close().size();
    }
    EXPECT_GT(found, 1000u);
}

TEST(Cones, a_bar_that_is_held_over_a_rim_turns_and_gives_the_torque_of_its_lever) {
    HapticModel model(plate_and_bar(), "cones");
    const Quaterniond lying = about(Vector3d::UnitY(), -90);  // shaft along -x
    const Vector3d tip(50, 0, -2);                            // beyond the plate; from x = 20 on it is above
    const TickResult result = rest_at(model, turned_at(tip, lying), 5);
    EXPECT_GT(force_of(result).z(), 0.1);
    const Vector3d rim(20, 0, 0), arm = rim - tool_of(result);
    const double tolerance = 0.03 * torque_of(result).norm();
    EXPECT_NEAR(torque_of(result).y(), arm.cross(force_of(result)).y(), tolerance);
    EXPECT_LT(std::abs(torque_of(result).x()), tolerance);
}

// Minima that come and go take their force along at once, so a closed way is not without loss here; it gives
// little.
TEST(Cones, a_closed_loop_of_position_and_orientation_gives_hardly_any_energy) {
    HapticModel model(plate_and_bar(), "cones");
    const Loop loop = work_of_loop(model, 450);
    RecordProperty("work_of_stored", std::to_string(loop.work / loop.stored));
    EXPECT_GT(loop.stored, 0.3);
    EXPECT_LT(loop.work, 0.05 * loop.stored);
}

TEST(Cones, a_tool_that_begins_inside_feels_nothing_until_it_has_been_clear) {
    feels_nothing_from_inside("cones");
    HapticModel model(plate_and_bar(), "cones");
    TickResult result{};
    model.tick(turned_at({0, 0, -1}, Quaterniond::Identity()), result);
    EXPECT_GT(force_of(rest_at(model, turned_at({0, 0, -1}, Quaterniond::Identity()), 4)).z(), 0.1);
}

TEST(Cones, no_tool_passes_through_a_thin_sheet_at_any_speed) {
    throw_on_sheet("cones", [](const HapticModel&, const TickResult& result) {
        ASSERT_FALSE(result.status & starts_inside);
        ASSERT_GT(lowest_of_bar(result), 0);
    });
}

TEST(Cones, pressed_harder_than_a_minimum_bears_a_tool_stays_outside_and_comes_away_again) {
    Case c = plate_and_bar();
    c.haptics.max_force = 3;
    c.tool->settings.contact_stiffness = 10;  // 3 N from 0.3 mm on, and 5 N are asked for
    HapticModel model(c, "cones");
    const Quaterniond on_a_corner = about(Vector3d(1, 1, 0).normalized(), 35);
    TickResult result{};
    double nearest = 1;
    for (int tick = 0; tick < 2000; ++tick) {
        const double z = 5 - 15 * std::sin(std::numbers::pi * tick / 2000.0);
        model.tick(turned_at({0, 0, z}, on_a_corner), result);
        ASSERT_GT(lowest_of_bar(result), 0) << tick;
        nearest = std::min(nearest, lowest_of_bar(result));
    }
    EXPECT_LT(nearest, 0.02);
    EXPECT_LT((tool_of(result) - Vector3d(0, 0, 5)).norm(), 0.1);
}

TEST(Cones, without_a_body_of_its_own_the_tool_is_the_cases_ball) {
    Case c = plate();
    c.haptics.max_force = 3;  // on 10 N/mm: a reach of 0.3 mm
    HapticModel model(c, "cones");
    EXPECT_EQ(model.contact_radius(), 1);
    const TickResult result = rest_at(model, held_at({0, 0, 0}));
    const double gap = tool_of(result).z() - 1;
    EXPECT_GT(gap, 0);
    EXPECT_LT(gap, 0.3);
    EXPECT_NEAR(force_of(result).z(), coupling * (1 + gap), 1e-6);
}

TEST(Cones, ticks_without_allocation) {
    HapticModel model(plate_and_bar(), "cones");
    TickResult result{};
    model.tick(turned_at({0, 0, 5}, Quaterniond::Identity()), result);
    const AllocationTrap trap;
    for (int tick = 0; tick < 300; ++tick)
        model.tick(turned_at({0.01 * tick, 0, 3 - 0.02 * tick}, about(Vector3d::UnitX(), 0.1 * tick)),
                   result);
    EXPECT_EQ(trap.count(), 0U);
    EXPECT_GT(force_of(result).norm(), 0.5);
}

TEST(Cones, refuses_a_case_without_rigid_bodies_and_a_tool_of_too_many_triangles) {
    EXPECT_THROW(HapticModel(soft_cube(2), "cones"), InvalidInput);
    Case c = plate_and_bar();
    c.tool->surface = collision::split_long_edges(c.tool->surface, 0.1, 1'000'000);
    ASSERT_GT(c.tool->surface.triangles.size(), ConeContact::most_triangles);
    EXPECT_THROW(HapticModel(c, "cones"), InvalidInput);
}

}  // namespace
}  // namespace palpate
