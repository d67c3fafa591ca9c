// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>
#include <string>
#include <utility>

#include "formats/model/arrays.hpp"
#include "runtime/haptics/tool_pose.hpp"
#include "tests/runtime/haptics/held_tool.hpp"
#include "tests/runtime/samples.hpp"

namespace palpate {

/// A bar of 2 by 2 by 40 mm along its shaft, its tip's face at z = 0 of the tool.
inline ToolBody bar() {
    return {.surface = box({-1, -1, 0}, {1, 1, 40}),
            .settings = {.shell_points = 2000,
                         .voxel = 0.5,
                         .contact_stiffness = 100,
                         .max_torque = 9999,
                         .max_torque_rate = 9999}};
}

inline constexpr double coupling = 0.5;  ///< N/mm, of wide_limits()

inline Case plate_and_bar() {
    Case c = plate();
    c.tool = bar();
    return c;
}

inline realtime::DeviceState turned_at(const Eigen::Vector3d& p, const Eigen::Quaterniond& orientation) {
    realtime::DeviceState state = held_at(p, orientation * Eigen::Vector3d::UnitZ());
    state.orientation = array_of(orientation);
    return state;
}

inline Eigen::Quaterniond about(const Eigen::Vector3d& axis, double degrees) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(degrees * std::numbers::pi / 180, axis));
}

/// Ticks until the tool rests at `state`, coming from `lift` mm above.
inline TickResult rest_at(haptics::HapticModel& model, realtime::DeviceState state, double lift = 3) {
    const double low = state.position[2];
    TickResult result{};
    for (int tick = 0; tick <= 300; ++tick) {
        state.position[2] = low + lift * std::max(0.0, 1 - tick / 250.0);
        model.tick(state, result);
    }
    return result;
}

inline Eigen::Vector3d torque_of(const TickResult& result) {
    return vector_of(result.torque);
}

/// What contacts do to a tool of spheres about its tip, N mm: what presses a sphere acts through its centre,
/// what rubs it where all that presses it on one body, or on the rigid ones, would meet its surface.
inline Eigen::Vector3d moment_on_spheres(const haptics::HapticModel& model, const TickResult& result) {
    using Eigen::Vector3d;
    const auto contacts = result.active_contacts();
    const auto bodies_of = [&](const Contact& contact) {
        return contact.body < static_cast<std::int32_t>(model.rigid_count()) ? -1 : contact.body;
    };
    Vector3d moment = Vector3d::Zero();
    for (const Contact& contact : contacts) {
        if (is_of_neighbour(contact)) continue;
        Vector3d push = Vector3d::Zero();
        for (const Contact& other : contacts)
            if (other.part == contact.part && bodies_of(other) == bodies_of(contact))
                push += static_cast<double>(other.force) * normal_of(other);
        const auto& [centre, radius] = model.tool_spheres()[static_cast<std::size_t>(contact.part)];
        const Vector3d arm = quaternion_of(result.tool_orientation) * centre,
                       press = static_cast<double>(contact.force) * normal_of(contact);
        moment += arm.cross(press);
        if (contact.force > 0)
            moment += (arm - radius * push.normalized()).cross(force_on_tool(contact) - press);
    }
    return moment;
}

/// Of a closed way of position and orientation through contact with what is about the origin, from above and
/// back.
struct Loop {
    double work = 0, stored = 0;  ///< N mm: given to the hand, and held by the springs at most
};
inline Loop work_of_loop(haptics::HapticModel& model, double torsional_stiffness) {
    using Eigen::Vector3d;
    const auto device = [](double s) {
        const double angle = 2 * std::numbers::pi * s;
        return haptics::ToolPose{{4 * std::sin(angle), 2 * std::sin(2 * angle), 1.5 * std::cos(angle) - 0.5},
                                 about(Vector3d::UnitX(), 20 * std::sin(angle)) *
                                     about(Vector3d::UnitY(), 30 * (1 - std::cos(angle)))};
    };
    constexpr int ticks = 4000;
    Loop loop;
    TickResult result{}, before{};
    for (int tick = 0; tick <= ticks; ++tick) {
        const haptics::ToolPose at = device(tick / double(ticks)), from = device((tick - 1) / double(ticks));
        model.tick(turned_at(at.position, at.orientation), result);
        if (tick > 0)
            loop.work += 0.5 * (force_of(result) + force_of(before)).dot(at.position - from.position) +
                         0.5 * (torque_of(result) + torque_of(before))
                                   .dot(rotation_between(from.orientation, at.orientation));
        const double turn = torque_of(result).squaredNorm() / torsional_stiffness;
        loop.stored = std::max(loop.stored, 0.5 * (force_of(result).squaredNorm() / coupling + turn));
        before = result;
    }
    return loop;
}

inline haptics::ToolPose any_pose(double near, std::mt19937& random) {
    std::normal_distribution<double> component(0, 1);
    const auto vector = [&] {
        return Eigen::Vector3d(component(random), component(random), component(random));
    };
    return {near * vector(), Eigen::Quaterniond(Eigen::AngleAxisd(component(random), vector().normalized()))};
}

/// Throws the bar on a sheet of a hundredth of a millimetre, at up to 1 m/s and 20 rad/s, and leaves it
/// there; its far end may come first, on which it then falls over. `look` sees every tick.
template <typename Look>
void throw_on_sheet(const std::string& scheme, const Look& look) {
    Case c = plate_and_bar();
    c.rigid_bodies[0] = rigid("sheet", box({-60, -60, -0.01}, {60, 60, 0}));
    haptics::HapticModel model(c, scheme);
    std::mt19937 random(9);
    std::uniform_real_distribution<double> part(0, 1);
    for (int approach = 0; approach < samples_of(200); ++approach) {
        SCOPED_TRACE(approach);
        model.reset();
        const double speed = 0.05 + 0.95 * part(random), turn = 0.02 * part(random);  // mm and rad a tick
        const haptics::ToolPose drawn = any_pose(1, random);
        const Eigen::Vector3d axis = drawn.position.normalized();
        const auto ticks = static_cast<int>(50 / speed);
        TickResult result{};
        for (int tick = 0; tick < ticks; ++tick) {
            const Eigen::Quaterniond turned(Eigen::AngleAxisd(turn * tick, axis));
            model.tick(turned_at({0, 0, 45 - speed * tick}, turned * drawn.orientation), result);
            look(std::as_const(model), std::as_const(result));
            if (testing::Test::HasFatalFailure()) return;
        }
        EXPECT_GT(force_of(result).z(), 0.5);
    }
}

/// A tool that begins inside a body says so and feels nothing: with its tip's face in the plate, through all
/// of it, and within a block of which it cuts no triangle.
inline void feels_nothing_from_inside(const std::string& scheme) {
    const auto begins_inside = [](haptics::HapticModel& model, double z) {
        TickResult result{};
        model.tick(turned_at({0, 0, z}, Eigen::Quaterniond::Identity()), result);
        EXPECT_TRUE(result.status & starts_inside) << z;
        EXPECT_EQ(force_of(result).norm(), 0) << z;
    };
    haptics::HapticModel model(plate_and_bar(), scheme);
    for (const double z : {-1.0, -30.0}) {
        model.reset();
        begins_inside(model, z);
    }
    Case c = plate_and_bar();
    c.rigid_bodies[0] = rigid("block", box({-60, -60, -60}, {60, 60, 60}));
    haptics::HapticModel within(c, scheme);
    begins_inside(within, 0);
}

}  // namespace palpate
