// SPDX-License-Identifier: Apache-2.0
// Friction of bone on tools that turn by themselves, in continuous contact.
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <vector>

#include "tests/runtime/allocation_trap.hpp"
#include "tests/runtime/haptics/turning/turned_tool.hpp"

namespace palpate {
namespace {

using namespace haptics;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double stiff_torsion = 450;     // N mm/rad
constexpr Friction on_bone{0.4, 0.3};     // at rest, sliding
constexpr double pressed = 2 * coupling;  // N, 2 mm deep

// A tick says ok within 0.01 mm of rest: that is so much of the coupling, N, and of a bar's torsion, N mm.
constexpr double settled_force = 5e-3, settled_torque = 0.2;
constexpr double told_beyond =
    2e-3;  // N that a drag may be told above its bound, by the press of that instant

Case on_plate(const Friction& friction) {
    Case c = plate_and_bar();
    c.tool->settings.torsional_stiffness = stiff_torsion;
    c.haptics.friction_at_rest = friction.at_rest;
    c.haptics.friction_sliding = friction.sliding;
    return c;
}

// How far the tool's tip, or what is `beside` it, goes from one pose to the other, mm.
double way_between(const TickResult& from, const TickResult& to, const Vector3d& beside) {
    const auto at = [&](const TickResult& result) {
        return Vector3d(tool_of(result) + quaternion_of(result.tool_orientation) * beside);
    };
    return (at(to) - at(from)).norm();
}

TEST(TurningFriction, drags_a_bar_by_coulombs_law) {
    HapticModel model(on_plate(on_bone));
    TickResult result = rest_at(model, turned_at({-5, 0, -2}, Quaterniond::Identity()));
    EXPECT_LT(drag_of(result).norm(), 0.01);
    for (int tick = 1; tick < 800; ++tick) {
        const double way = 0.01 * tick;
        model.tick(turned_at({-5 + 0.8 * way, 0.6 * way, -2}, Quaterniond::Identity()), result);
        ASSERT_EQ(result.status, tick_ok) << tick;
        const Vector3d force = force_of(result), drag = drag_of(result);
        EXPECT_NEAR(press_of(result), force.z(), 1e-4) << tick;
        EXPECT_LT((drag.head<2>() - force.head<2>()).norm(), 1e-4) << tick;
        EXPECT_LE(drag.norm(), on_bone.at_rest * press_of(result) + 1e-3) << tick;
        EXPECT_LT((torque_of(result) - moment_on_spheres(model, result)).norm(), 1e-2) << tick;
        // It sticks until the spring pulls with 0.4 N, 0.8 mm on, and slides with 0.3 N from soon after on.
        if (way < 0.7) {
            EXPECT_NEAR(drag.norm(), coupling * way, 0.01) << tick;
        } else if (way > 2) {
            EXPECT_NEAR(drag.norm(), on_bone.sliding * press_of(result), 1e-3) << tick;
        }
        EXPECT_LT(drag.dot(Vector3d(0.8, 0.6, 0)), 0) << tick;
    }
}

// Two of its spheres bear it. Once one slides it turns about the other, until both do.
TEST(TurningFriction, holds_a_bar_that_is_twisted_on_its_end_until_it_slides) {
    for (const Friction& friction : {on_bone, Friction{}}) {
        HapticModel model(on_plate(friction));
        TickResult result = rest_at(model, turned_at({0, 0, -2}, Quaterniond::Identity()));
        const TickResult rest = result;
        double last = 0, most = 0;  // N mm
        bool slides = false;
        for (int tick = 1; tick <= 400; ++tick) {
            const double degrees = 0.02 * tick;
            model.tick(turned_at({0, 0, -2}, about(Vector3d::UnitZ(), degrees)), result);
            ASSERT_EQ(result.status, tick_ok) << tick;
            most = 0;
            for (const Contact& contact : result.active_contacts()) {
                const Vector3d& arm = model.tool_spheres()[static_cast<std::size_t>(contact.part)].centre;
                most += static_cast<double>(contact.force) * std::hypot(arm.x(), arm.y());
            }
            const double torque = -torque_of(result).z();
            EXPECT_LE(torque, friction.at_rest * most + 1e-3) << degrees;
            slides = slides || torque < last - 0.01;
            // Until then the wall gives way to friction by less than a micrometre, half a millimetre from the
            // axis and more: that is two thirds of what the spring would bear.
            if (friction.any() && !slides) {
                EXPECT_GT(torque, 0.6 * stiff_torsion * degrees * std::numbers::pi / 180) << degrees;
                EXPECT_LT(way_between(rest, result, {1, 1, 0}), 1e-3) << degrees;
            }
            if (friction.any() && slides) {
                EXPECT_GT(torque, 0.8 * friction.sliding * most) << degrees;
            }
            last = torque;
        }
        EXPECT_GT(most, 0.5);  // of 1 N
        EXPECT_EQ(slides, friction.any());
        EXPECT_GE(last, friction.sliding * most - 1e-3);
    }
}

// Held on one side by what friction bears, with all springs strained.
TEST(TurningFriction, holds_without_creeping) {
    HapticModel model(on_plate(on_bone));
    const auto at = [](double part) {
        return turned_at({0.5 * part, -0.1 * part, -2},
                         about(Vector3d::UnitZ(), 0.02 * part) * about(Vector3d::UnitX(), 0.05 * part));
    };
    rest_at(model, at(0));
    TickResult result{};
    for (int tick = 1; tick <= 500; ++tick) model.tick(at(tick / 500.0), result);
    const TickResult before = result;
    ASSERT_GT(drag_of(before).norm(), 0.2);
    for (int tick = 0; tick < 5000; ++tick) model.tick(at(1), result);
    EXPECT_LT((force_of(result) - force_of(before)).norm(), 1e-3);
    for (const Vector3d& beside : {Vector3d(1, 1, 0), Vector3d(-1, 1, 0), Vector3d(0, 0, 40)})
        EXPECT_LT(way_between(before, result, beside), 2e-3);
}

// A ball that is tilted about its centre rolls until the coupling pulls it back as hard as friction bears.
TEST(TurningFriction, acts_where_a_sphere_touches) {
    Case c = plate();
    c.tool = ToolBody{.surface = {}, .settings = bar().settings};
    c.tool->settings.rod_length = 30;
    c.tool->settings.torsional_stiffness = stiff_torsion;
    c.haptics.friction_at_rest = c.haptics.friction_sliding = on_bone.sliding;
    HapticModel model(c);
    const double radius = c.haptics.tool_radius;
    TickResult result = rest_at(model, turned_at({0, 0, radius - 2}, Quaterniond::Identity()));
    for (int tick = 1; tick <= 600; ++tick) {
        const double angle = tick * std::numbers::pi / 180 / 10;
        model.tick(turned_at({0, 0, radius - 2}, about(Vector3d::UnitX(), 0.1 * tick)), result);
        const double rolls = coupling * radius * angle, most = on_bone.sliding * pressed;
        EXPECT_NEAR(-force_of(result).y(), std::min(rolls, most), 0.01) << angle;
        EXPECT_NEAR(-torque_of(result).x(), std::min(rolls, most) * radius, 0.01) << angle;
    }
}

TEST(TurningFriction, gives_no_energy_over_closed_ways) {
    for (const bool rough : {true, false}) {
        HapticModel model(on_plate(rough ? on_bone : Friction{}));
        const Loop loop = work_of_loop(model, stiff_torsion);
        EXPECT_GT(loop.stored, 1);
        if (rough) {
            EXPECT_LT(loop.work, -0.1 * loop.stored);
        } else {
            EXPECT_LT(std::abs(loop.work), 0.01 * loop.stored);
        }
    }
}

// A coefficient for tools at rest alone: what slides is not held at all.
TEST(TurningFriction, lets_go_of_what_slides_where_only_what_rests_is_held) {
    HapticModel model(on_plate({0.4, 0}));
    TickResult result = rest_at(model, turned_at({0, 0, -2}, Quaterniond::Identity()));
    double most = 0;
    for (int tick = 1; tick <= 400; ++tick) {
        model.tick(turned_at({0.01 * tick, 0, -2}, Quaterniond::Identity()), result);
        ASSERT_EQ(result.status, tick_ok) << tick;
        most = std::max(most, drag_of(result).norm());
    }
    EXPECT_NEAR(most, 0.4 * pressed, 0.06);
    EXPECT_LT(drag_of(result).norm(), 0.8 * most);
}

// A soft block beside a plate of bone, both tops at z = 0; a bar lies across.
TEST(TurningFriction, of_tissue_and_of_bone_hold_a_tool_together) {
    Case c = soft_cube(4);
    c.deformable_bodies[0] = moved(c.deformable_bodies[0], {-22, -10, -20});
    c.rigid_bodies.push_back(rigid("bone", box({0, -20, -20}, {40, 20, 0})));
    c.tool = bar();
    c.haptics.friction_at_rest = on_bone.at_rest;
    c.haptics.friction_sliding = on_bone.sliding;
    HapticModel model(c);
    const auto at = [](double aside, double turn) {
        return turned_at({-15, aside, -1.5}, about(Vector3d::UnitZ(), turn) * about(Vector3d::UnitY(), 90));
    };
    TickResult result = rest_at(model, at(0, 0), 5);
    int soft = 0, hard = 0, unsettled = 0;
    for (int tick = 1; tick <= 1500; ++tick) {
        model.tick(at(0.002 * tick, 3 * std::sin(0.004 * tick)), result);
        ASSERT_EQ(result.status & ~std::uint32_t{contact_unsettled}, 0U) << tick;
        unsettled += result.status != tick_ok;
        Vector3d told = Vector3d::Zero();
        for (const Contact& contact : result.active_contacts()) {
            told += force_on_tool(contact);
            (contact.body == 0 ? hard : soft) += contact.force > 0;
            const Vector3d drag = Eigen::Map<const Eigen::Vector3f>(contact.friction.data()).cast<double>();
            EXPECT_LE(drag.norm(), on_bone.at_rest * static_cast<double>(contact.force) + told_beyond)
                << tick;
        }
        EXPECT_LT((told - force_of(result)).norm(), settled_force) << tick;
        EXPECT_LT((torque_of(result) - moment_on_spheres(model, result)).norm(), settled_torque) << tick;
    }
    EXPECT_GT(soft, 1000);
    EXPECT_GT(hard, 1000);
    EXPECT_LT(unsettled, 15);
    EXPECT_GT(drag_of(result).norm(), 0.05);
}

// Pushed about, over the plate's rim too.
realtime::DeviceState pushed_about(int tick) {
    const double s = 0.004 * tick;
    return turned_at(
        {24 * std::sin(s), 11 * std::sin(0.7 * s), 3 * std::cos(s)},
        about(Vector3d::UnitX(), 50 * std::sin(1.3 * s)) * about(Vector3d::UnitZ(), 90 * std::sin(0.9 * s)));
}

TEST(TurningFriction, what_follows_a_free_tick_does_not_depend_on_how_it_was_come_to) {
    HapticModel model(on_plate(on_bone)), other(on_plate(on_bone));
    TickResult result{}, same{};
    model.tick(pushed_about(0), result);
    other.tick(pushed_about(0), same);
    for (int tick = 600; tick < 900; ++tick) model.tick(pushed_about(tick), result);  // through contact
    for (haptics::HapticModel* each : {&model, &other})
        for (int tick = 0; tick < 2; ++tick)
            each->tick(turned_at({0, 0, 9}, Quaterniond::Identity()), each == &model ? result : same);
    ASSERT_EQ(result.contact_count, 0);
    int touching = 0;
    for (int tick = 0; tick < 600; ++tick) {
        const auto state =
            turned_at({0.01 * tick, 0, 1 - 0.005 * tick}, about(Vector3d::UnitZ(), 0.02 * tick));
        model.tick(state, result);
        other.tick(state, same);
        touching += drag_of(result).norm() > 0;
        ASSERT_EQ(result.force, same.force) << tick;
        ASSERT_EQ(result.torque, same.torque) << tick;
    }
    EXPECT_GT(touching, 200);
}

TEST(TurningFriction, keeps_to_its_law_on_each_of_two_tools) {
    HapticModel model(on_plate(on_bone), "continuous", 2);
    std::array<TickResult, 2> results{};
    int touching = 0, unsettled = 0;
    for (int tick = 0; tick < 3000; ++tick) {
        model.tick(std::array{pushed_about(tick), pushed_about(tick + 1500)}, results);
        touching += drag_of(results[0]).norm() > 0 && drag_of(results[1]).norm() > 0;
        for (const TickResult& result : results) {
            ASSERT_EQ(result.status & ~std::uint32_t{contact_unsettled}, 0U) << tick;
            unsettled += result.status != tick_ok;
            for (const Contact& contact : result.active_contacts()) {
                const auto drag = Eigen::Map<const Eigen::Vector3f>(contact.friction.data());
                EXPECT_LE(drag.norm(), on_bone.at_rest * contact.force + told_beyond) << tick;
            }
            if (result.status == tick_ok && result.contact_count > 1) {
                EXPECT_LT((torque_of(result) - moment_on_spheres(model, result)).norm(), settled_torque)
                    << tick;
            }
        }
    }
    EXPECT_GT(touching, 300);
    EXPECT_LT(unsettled, 60);
}

TEST(TurningFriction, does_not_remember_what_was_before_a_reset) {
    HapticModel model(on_plate(on_bone));
    std::vector<TickResult> first(3000);
    TickResult result{};
    for (int tick = 0; tick < 3000; ++tick) model.tick(pushed_about(tick), first[std::size_t(tick)]);
    model.tick(pushed_about(1000), result);  // in contact
    model.reset();
    for (int tick = 0; tick < 3000; ++tick) {
        model.tick(pushed_about(tick), result);
        ASSERT_EQ(result.force, first[std::size_t(tick)].force) << tick;
        ASSERT_EQ(result.torque, first[std::size_t(tick)].torque) << tick;
    }
}

TEST(TurningFriction, a_tick_never_allocates) {
    HapticModel model(on_plate(on_bone));
    TickResult result{};
    int touching = 0;
    std::size_t allocated = 0;
    {
        const AllocationTrap trap;
        for (int tick = 0; tick < 3000; ++tick) {
            model.tick(pushed_about(tick), result);
            touching += drag_of(result).norm() > 0;
        }
        allocated = trap.count();
    }
    EXPECT_EQ(allocated, 0U);
    EXPECT_GT(touching, 600);
}

}  // namespace
}  // namespace palpate
