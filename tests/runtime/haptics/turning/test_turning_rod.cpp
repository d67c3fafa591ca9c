// SPDX-License-Identifier: Apache-2.0
// A rod that hangs on a spring of torsion: it gives way by turning, and gives torque.
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "formats/model/arrays.hpp"
#include "formats/model/errors.hpp"
#include "runtime/haptics/tool_pose.hpp"
#include "tests/runtime/haptics/turning/turned_tool.hpp"

namespace palpate {
namespace {

using namespace haptics;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double torsion = 100;          // N mm/rad
constexpr double float_rounding = 1e-6;  // relative: contacts are told in float32

// A rod of 1 mm radius and 12 mm length that lies along x over the cube's top, turns where `turning`.
Case cube_and_rod(bool turning, double friction = 0) {
    Case c = soft_cube(4);
    c.haptics.shaft_length = 12;
    c.haptics.friction_at_rest = c.haptics.friction_sliding = friction;
    if (turning)
        c.tool = ToolBody{
            .surface = {},
            .settings = {.torsional_stiffness = torsion, .max_torque = 9999, .max_torque_rate = 9999}};
    return c;
}

realtime::DeviceState rod_at(const Vector3d& tip, const Vector3d& shaft) {
    return held_at(tip, shaft.normalized());
}

// Ticks until it rests, coming from `height` mm above.
TickResult rest_at(HapticModel& model, const Vector3d& tip, const Vector3d& shaft, double height = 3) {
    TickResult result{};
    for (int tick = 0; tick <= 400; ++tick) {
        const double lift = height * std::max(0.0, 1 - tick / 300.0);
        model.tick(rod_at(tip + Vector3d(0, 0, lift), shaft), result);
    }
    return result;
}

TEST(TurningRod, its_torque_is_the_moment_of_its_contacts_and_what_the_spring_is_turned_by) {
    for (const double friction : {0.0, 0.3}) {
        HapticModel model(cube_and_rod(true, friction));
        // The tip hangs beside the cube, most of the shaft lies on its top.
        const Vector3d shaft = Vector3d(-1, 0.1, -0.05).normalized();
        const TickResult result = rest_at(model, {22, 9, 20}, shaft);
        EXPECT_EQ(result.status, tick_ok) << friction;
        ASSERT_GT(result.contact_count, 0);
        const Vector3d torque = vector_of(result.torque);
        EXPECT_GT(torque.norm(), 0.3);
        EXPECT_LT((torque - moment_on_spheres(model, result)).norm(), float_rounding * torque.norm())
            << friction;
        const Quaterniond device = Quaterniond::FromTwoVectors(Vector3d::UnitZ(), shaft);
        const Vector3d turn = rotation_between(device, quaternion_of(result.tool_orientation));
        EXPECT_LT((torque - torsion * turn).norm(), 1e-6);
    }
}

TEST(TurningRod, it_gives_way_and_so_presses_less_than_one_that_its_device_turns) {
    HapticModel turning(cube_and_rod(true)), held(cube_and_rod(false));
    const Vector3d tip(22, 9, 20), shaft(-1, 0, -0.1);
    const TickResult gives = rest_at(turning, tip, shaft), stays = rest_at(held, tip, shaft);
    EXPECT_LT(force_of(gives).norm(), 0.98 * force_of(stays).norm());
    EXPECT_EQ(vector_of(stays.torque).norm(), 0);
    EXPECT_EQ(stays.tool_orientation, (std::array<double, 4>{0, 0, 0, 0}));
}

TEST(TurningRod, on_a_stiff_spring_it_is_the_rod_that_its_device_turns) {
    Case stiff = cube_and_rod(true);
    stiff.tool->settings.torsional_stiffness = 1e5;
    HapticModel turning(stiff), held(cube_and_rod(false));
    const Vector3d tip(22, 9, 20), shaft(-1, 0, -0.1);
    const TickResult turned = rest_at(turning, tip, shaft), stays = rest_at(held, tip, shaft);
    EXPECT_LT((force_of(turned) - force_of(stays)).norm(), 2e-3 * force_of(stays).norm());
}

TEST(TurningRod, a_closed_loop_of_its_tip_and_shaft_gives_no_energy) {
    HapticModel model(cube_and_rod(true));
    const auto pose = [](double s) {
        const double angle = 2 * std::numbers::pi * s;
        return std::pair(
            Vector3d(21 + std::sin(angle), 9 + std::sin(2 * angle), 20.9 + 1.2 * std::cos(angle)),
            Vector3d(-1, 0.15 * std::sin(angle), -0.1 + 0.1 * std::sin(2 * angle)).normalized());
    };
    constexpr int ticks = 4000;
    double work = 0, stored = 0;
    TickResult result{}, before{};
    for (int tick = 0; tick <= ticks; ++tick) {
        const auto [tip, shaft] = pose(tick / double(ticks));
        const auto [last_tip, last_shaft] = pose((tick - 1) / double(ticks));
        model.tick(rod_at(tip, shaft), result);
        if (tick > 0)
            work += 0.5 * (force_of(result) + force_of(before)).dot(tip - last_tip) +
                    0.5 * (vector_of(result.torque) + vector_of(before.torque)).dot(last_shaft.cross(shaft));
        // What springs and tissue hold: half of force times way.
        double energy = 0.5 * (force_of(result).squaredNorm() / HapticSettings{}.coupling_stiffness +
                               vector_of(result.torque).squaredNorm() / torsion);
        for (const Contact& contact : result.active_contacts())
            energy += 0.5 * double(contact.force * contact.gap);
        stored = std::max(stored, energy);
        before = result;
    }
    EXPECT_GT(stored, 0.05);
    EXPECT_LT(std::abs(work), 0.01 * stored);
}

TEST(TurningRod, walls_turn_it_too) {
    Case c = plate();
    c.haptics.shaft_length = 12;
    c.tool =
        ToolBody{.surface = {},
                 .settings = {.torsional_stiffness = torsion, .max_torque = 9999, .max_torque_rate = 9999}};
    HapticModel model(c);
    // The tip is beyond the plate's rim at x = 20, the shaft 2 mm too low over its top.
    const TickResult result = rest_at(model, {25, 0, -1}, {-1, 0, 0});
    EXPECT_EQ(result.status, tick_ok);
    const Vector3d torque = vector_of(result.torque);
    EXPECT_GT(torque.y(), 1);
    EXPECT_LT((torque - moment_on_spheres(model, result)).norm(), float_rounding * torque.norm());
}

TEST(TurningRod, walls_turn_it_far_as_its_spring_says) {
    Case c = plate();
    c.haptics.shaft_length = 30;
    c.tool = ToolBody{.surface = {},
                      .settings = {.torsional_stiffness = 40, .max_torque = 9999, .max_torque_rate = 9999}};
    HapticModel model(c);
    const TickResult result = rest_at(model, {45, 0, -8}, {-1, 0, 0}, 12);
    EXPECT_EQ(result.status, tick_ok);
    const Vector3d torque = vector_of(result.torque);
    EXPECT_GT(torque.norm() / 40, 0.3);  // rad
    EXPECT_LT((torque - moment_on_spheres(model, result)).norm(), float_rounding * torque.norm());
}

TEST(TurningRod, without_a_shaft_there_is_nothing_to_turn) {
    Case c = plate();
    c.tool = ToolBody{};
    EXPECT_THROW(HapticModel(c, "continuous"), InvalidInput);
    c.tool->settings.rod_length = 20;
    EXPECT_NO_THROW(HapticModel(c, "continuous"));
}

}  // namespace
}  // namespace palpate
