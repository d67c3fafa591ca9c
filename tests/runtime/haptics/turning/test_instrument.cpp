// SPDX-License-Identifier: Apache-2.0
// An instrument with a surface of its own in continuous contact: spheres that fill it feel tissue and bone.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

#include "formats/model/contact/compliance_blocks.hpp"
#include "runtime/haptics/whole_tool/rod.hpp"
#include "tests/runtime/allocation_trap.hpp"
#include "tests/runtime/collision/collision_scene.hpp"
#include "tests/runtime/haptics/turning/turned_tool.hpp"

namespace palpate {
namespace {

using namespace haptics;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double told_rounding = 1e-6;  // relative: contacts are told in float32
constexpr double twist = 100;           // N mm/rad
// mm: a plane that turning bends is passed by up to 0.002 mm before the next tick finds it.
constexpr double passed_by = 0.005;

ToolBody instrument(const TriangleMesh& surface, double torsional_stiffness = twist) {
    return {.surface = surface,
            .settings = {
                .torsional_stiffness = torsional_stiffness, .max_torque = 9999, .max_torque_rate = 9999}};
}

// The true elastic cube with the middle of its top at the origin.
Case soft_block(int cells) {
    Case c = soft_cube(cells);
    c.deformable_bodies[0] = moved(c.deformable_bodies[0], {-10, -10, -20});
    return c;
}

Case soft_block_and(const TriangleMesh& surface, double friction = 0) {
    Case c = soft_block(4);
    c.tool = instrument(surface);
    c.haptics.friction_at_rest = c.haptics.friction_sliding = friction;
    return c;
}

// How far a sphere of the tool is in a rigid body, mm; of depths up to 5 mm.
double deepest_sphere(const HapticModel& model, const TickResult& result) {
    double deepest = 0;
    for (const auto& [place, radius] : model.tool_spheres()) {
        const Vector3d at = tool_of(result) + quaternion_of(result.tool_orientation) * place;
        for (std::size_t body = 0; body < model.rigid_count(); ++body) {
            const auto near = model.surface(body).closest_point(at, 5);
            if (!near) continue;
            const double outside =
                model.surface(body).is_outside(at, *near) ? near->distance : -near->distance;
            deepest = std::max(deepest, radius - outside);
        }
    }
    return deepest;
}

TEST(Instrument, that_is_a_ball_is_felt_as_the_cases_own) {
    Case c = soft_block(4);
    HapticModel ball(c);
    c.tool = instrument(rod_surface(1, 0));
    HapticModel same(c);
    const auto at = turned_at({1, 0.5, 1 - 1.5}, about(Vector3d::UnitX(), 70));
    // Its faces lie up to 1.7 % inside the ball.
    EXPECT_NEAR(force_of(rest_at(same, at)).norm() / force_of(rest_at(ball, at)).norm(), 1, 0.04);
}

TEST(Instrument, its_torque_is_the_moment_of_its_contacts_and_what_the_spring_is_turned_by) {
    for (const double friction : {0.0, 0.3}) {
        HapticModel model(soft_block_and(box({-1, -1, 0}, {1, 1, 25}), friction));
        // It lies across an edge of the block, its tip beyond.
        const Quaterniond held = about(Vector3d::UnitY(), -84);
        const TickResult result = rest_at(model, turned_at({14, 1, -3}, held), 8);
        EXPECT_EQ(result.status, tick_ok) << friction;
        ASSERT_GT(result.contact_count, 0);
        const Vector3d torque = torque_of(result);
        EXPECT_GT(torque.norm(), 0.1);
        EXPECT_LT((torque - moment_on_spheres(model, result)).norm(), told_rounding * torque.norm())
            << friction;
        const Vector3d turn = rotation_between(held, quaternion_of(result.tool_orientation));
        EXPECT_LT((torque - twist * turn).norm(), 1e-6);
        EXPECT_LT(
            (force_of(result) - coupling * (vector_of(result.tool_position) - Vector3d(14, 1, -3))).norm(),
            1e-9);
    }
}

TEST(Instrument, its_torque_keeps_to_its_bounds_in_size_and_step_and_says_so) {
    const auto at = turned_at({14, 1, -3}, about(Vector3d::UnitY(), -84));
    Case c = soft_block_and(box({-1, -1, 0}, {1, 1, 25}));
    HapticModel unbounded(c);
    const Vector3d wanted = torque_of(rest_at(unbounded, at, 8));
    const double most = wanted.norm() / 3, most_a_tick = most / 10;  // N mm
    c.tool->settings.max_torque = most;
    c.tool->settings.max_torque_rate = most_a_tick;
    HapticModel model(c);
    TickResult result{};
    Vector3d before = Vector3d::Zero();
    bool limited = false, slowed = false;
    realtime::DeviceState state = at;
    for (int tick = 0; tick < 600; ++tick) {  // lowered on the block, and taken away at once
        state.position[2] = tick < 300 ? at.position[2] + 8 * std::max(0.0, 1 - tick / 250.0) : 40;
        model.tick(state, result);
        EXPECT_LE(torque_of(result).norm(), most * (1 + 1e-12)) << tick;
        EXPECT_LE((torque_of(result) - before).norm(), most_a_tick * (1 + 1e-12)) << tick;
        limited |= (result.status & force_limited) != 0;
        slowed |= (result.status & rate_limited) != 0;
        before = torque_of(result);
        if (tick == 299) {
            EXPECT_LT((before - wanted.normalized() * most).norm(), 1e-3 * most);
        }
    }
    EXPECT_TRUE(limited && slowed);
    EXPECT_EQ(before, Vector3d::Zero());
}

TEST(Instrument, its_torque_keeps_to_what_the_device_bears) {
    const auto at = turned_at({14, 1, -3}, about(Vector3d::UnitY(), -84));
    HapticModel model(soft_block_and(box({-1, -1, 0}, {1, 1, 25})));
    const double wanted = torque_of(rest_at(model, at, 8)).norm();
    const DeviceLimits weak{.max_torque = wanted / 2};
    model.couple_to({&weak, 1});
    EXPECT_NEAR(torque_of(rest_at(model, at, 8)).norm(), wanted / 2, 1e-9);
}

TEST(Instrument, a_closed_loop_of_position_and_orientation_gives_no_energy) {
    HapticModel model(soft_block_and(box({-1, -1, 0}, {1, 1, 25})));
    const auto device = [](double s) {
        const double angle = 2 * std::numbers::pi * s;
        return ToolPose{{3 * std::sin(angle), 2 * std::sin(2 * angle), 1.5 * std::cos(angle) - 0.7},
                        about(Vector3d::UnitX(), 20 * std::sin(angle)) *
                            about(Vector3d::UnitY(), 30 * (1 - std::cos(angle)))};
    };
    constexpr int ticks = 4000;
    double work = 0, stored = 0;
    TickResult result{}, before{};
    for (int tick = 0; tick <= ticks; ++tick) {
        const ToolPose at = device(tick / double(ticks)), from = device((tick - 1) / double(ticks));
        model.tick(turned_at(at.position, at.orientation), result);
        EXPECT_EQ(result.status & ~std::uint32_t{contact_unsettled}, 0U) << tick;
        if (tick > 0)
            work += 0.5 * (force_of(result) + force_of(before)).dot(at.position - from.position) +
                    0.5 * (torque_of(result) + torque_of(before))
                              .dot(rotation_between(from.orientation, at.orientation));
        // What springs and tissue hold: half of force times way.
        double energy =
            0.5 * (force_of(result).squaredNorm() / coupling + torque_of(result).squaredNorm() / twist);
        for (const Contact& contact : result.active_contacts())
            energy += 0.5 * static_cast<double>(contact.force * contact.gap);
        stored = std::max(stored, energy);
        before = result;
    }
    EXPECT_GT(stored, 0.02);
    EXPECT_LT(std::abs(work), 0.01 * stored);
    RecordProperty("work_of_stored", std::to_string(work / stored));
}

// A flat end is felt as flat, whatever spheres fill it: Boussinesq's F = 2 a E* d, on a cube that is no
// half-space and gives way by more, on coarse and on fine elements.
TEST(Instrument, a_flat_end_sinks_in_as_boussinesq_has_it) {
    const auto cylinder = [](double radius) {
        TriangleMesh mesh;
        constexpr std::int32_t sides = 48;
        mesh.vertices = {{0, 0, 0}, {0, 0, 30}};
        for (std::int32_t k = 0; k < sides; ++k) {
            const double angle = 2 * std::numbers::pi * k / sides;
            for (const double z : {0.0, 30.0})
                mesh.vertices.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
            const std::int32_t low = 2 + 2 * k, next = 2 + 2 * ((k + 1) % sides);
            mesh.triangles.insert(
                mesh.triangles.end(),
                {{0, next, low}, {low, next, next + 1}, {low, next + 1, low + 1}, {1, low + 1, next + 1}});
        }
        return mesh;
    };
    for (const double radius : {1.0, 2.5}) {
        std::array<double, 2> over_exact{};
        for (const int cells : {4, 8}) {
            Case c = soft_block(cells);
            const double modulus = surface_contact_modulus(c.deformable_bodies[0]);
            c.tool = instrument(cylinder(radius), 1e5);
            HapticModel model(c);
            const double force =
                force_of(rest_at(model, turned_at({0, 0, -1.2}, Quaterniond::Identity()))).norm();
            over_exact[cells / 8] = force / (2 * radius * modulus * (1.2 - force / coupling));
        }
        RecordProperty("of_" + std::to_string(radius),
                       std::to_string(over_exact[0]) + " and " + std::to_string(over_exact[1]));
        EXPECT_GT(over_exact[0], 0.82) << radius;
        EXPECT_LT(over_exact[1], 1.0) << radius;
        EXPECT_NEAR(over_exact[0], over_exact[1], 0.05) << radius;
    }
}

TEST(Instrument, is_felt_where_it_is_turned_to) {
    HapticModel model(soft_block_and(box({3, -1, 0}, {6, 1, 4})));
    const Vector3d tip(-12, 0, -1);  // beside the block, its body over the top or beyond
    EXPECT_GT(force_of(rest_at(model, turned_at(tip, Quaterniond::Identity()))).z(), 0.005);
    model.reset();
    EXPECT_EQ(rest_at(model, turned_at(tip, about(Vector3d::UnitZ(), 180))).contact_count, 0);
}

TEST(Instrument, bone_holds_it_as_it_is) {
    Case c = plate_and_bar();
    HapticModel model(c);
    const TickResult flat = rest_at(model, turned_at({0, 0, -2}, Quaterniond::Identity()));
    EXPECT_NEAR(force_of(flat).z(), coupling * 2, 0.01);
    EXPECT_LT(torque_of(flat).norm(), 0.1);
    model.reset();
    // Upside down, it stands on its other end.
    const TickResult turned = rest_at(model, turned_at({0, 0, 38}, about(Vector3d::UnitX(), 180)), 6);
    EXPECT_NEAR(force_of(turned).z(), coupling * 2, 0.01);
}

// Its spheres by themselves would rest elsewhere among the spikes than the tool does, on their far sides too.
TEST(Instrument, among_spikes_of_bone_is_held_outside_and_solved_in_every_tick) {
    Case c = plate_and_bar();
    c.rigid_bodies[0] = rigid("spikes", spiky_ball(3));
    const double top =
        std::ranges::max(c.rigid_bodies[0].surface.vertices, {}, [](const Vector3d& v) { return v.z(); }).z();
    HapticModel model(c);
    TickResult result{};
    double deepest = 0;
    int touching = 0;
    for (int tick = 0; tick < 8000; ++tick) {
        const double s = 1e-3 * tick;
        const Vector3d at(6 * std::sin(1.3 * s), 5 * std::sin(1.7 * s + 1),
                          top + 1 - 4 * (1 - std::cos(2.1 * s)));
        const Quaterniond turned = about(Vector3d::UnitX(), 25 * std::sin(1.1 * s)) *
                                   about(Vector3d::UnitY(), 25 * std::sin(0.9 * s)) *
                                   about(Vector3d::UnitZ(), 60 * std::sin(0.7 * s));
        model.tick(turned_at(at, turned), result);
        touching += result.contact_count > 0;
        ASSERT_EQ(result.status & ~std::uint32_t{contact_unsettled}, 0U) << tick;
        if (tick % 10 == 0) deepest = std::max(deepest, deepest_sphere(model, result));
    }
    EXPECT_GT(touching, 3000);
    EXPECT_LT(deepest, passed_by);
}

// Has it come down on what lies at the origin at up to 1 m/s and 20 rad/s; take(result before, result).
template <typename Take>
void throw_at(HapticModel& model, std::mt19937& random, const Take& take) {
    std::uniform_real_distribution<double> part(0, 1);
    model.reset();
    const double speed = 0.3 + 0.7 * part(random), turn = 0.02 * part(random);  // mm and rad a tick
    const ToolPose drawn = any_pose(1, random);
    const Vector3d axis = drawn.position.normalized();
    TickResult result{}, before{};
    for (int tick = 0; tick < static_cast<int>(70 / speed); ++tick) {
        before = result;
        const Quaterniond turned(Eigen::AngleAxisd(turn * tick, axis));
        model.tick(turned_at({5 * drawn.position.x(), 5 * drawn.position.y(), 60 - speed * tick},
                             turned * drawn.orientation),
                   result);
        take(before, result);
    }
}

// Some ticks find no place for it: there it stays where it was.
TEST(Instrument, thrown_among_spikes_of_bone_stays_where_it_was_if_a_tick_is_not_solved) {
    Case c = plate_and_bar();
    c.rigid_bodies[0] = rigid("spikes", spiky_ball(3));
    c.haptics.friction_at_rest = c.haptics.friction_sliding = 0.5;
    HapticModel model(c);
    std::mt19937 random(7);
    int unsolved = 0;
    for (int approach = 0; approach < 150; ++approach)
        throw_at(model, random, [&](const TickResult& before, const TickResult& result) {
            if ((result.status & contact_unsolved) == 0) return;
            ++unsolved;
            EXPECT_LT((tool_of(result) - tool_of(before)).norm(), 1e-9);
            EXPECT_LT(rotation_between(quaternion_of(before.tool_orientation),
                                       quaternion_of(result.tool_orientation))
                          .norm(),
                      1e-9);
        });
    EXPECT_GT(unsolved, 0);
}

// A sphere that slips past the point of one spike may run into the next one on the same way.
TEST(Instrument, thrown_among_spikes_of_bone_has_no_sphere_in_them_in_any_tick) {
    Case c = plate_and_bar();
    c.rigid_bodies[0] = rigid("spikes", spiky_ball(3));
    HapticModel model(c);
    std::mt19937 random(11);
    double deepest = 0;
    int touching = 0;
    for (int approach = 0; approach < 200; ++approach)
        throw_at(model, random, [&](const TickResult&, const TickResult& result) {
            if (result.contact_count == 0) return;
            ++touching;
            deepest = std::max(deepest, deepest_sphere(model, result));
        });
    EXPECT_GT(touching, 5000);
    EXPECT_LT(deepest, passed_by);
}

// It lies there on more walls than a tick solves.
TEST(Instrument, thrown_on_a_thin_sheet_has_no_sphere_in_it_in_any_tick) {
    double deepest = 0;
    throw_on_sheet("continuous", [&](const HapticModel& model, const TickResult& result) {
        const Quaterniond tool = quaternion_of(result.tool_orientation);
        for (const auto& [place, radius] : model.tool_spheres())
            deepest = std::max(deepest, radius - (tool_of(result) + tool * place).z());
        ASSERT_EQ(result.status & ~std::uint32_t{contact_unsettled}, 0U);
    });
    EXPECT_LT(deepest, passed_by);
}

// Where the device has it, it is deep in both blocks.
TEST(Instrument, in_a_slot_turns_as_far_as_the_slot_lets_it) {
    Case c;
    c.name = "slot";
    c.rigid_bodies = {rigid("left", box({-20, -20, -20}, {-1.5, 20, 0})),
                      rigid("right", box({1.5, -20, -20}, {20, 20, 0}))};
    c.haptics = wide_limits();
    c.tool = bar();
    HapticModel model(c);
    TickResult result{};
    double deepest = 0;
    for (int tick = 0; tick <= 3000; ++tick) {
        const double down = std::min(tick / 1500.0, 1.0), turned = std::max(0.0, tick / 1500.0 - 1);
        model.tick(turned_at({0, 0, 5 - 20 * down}, about(Vector3d::UnitY(), 30 * turned)), result);
        ASSERT_EQ(result.status & ~std::uint32_t{contact_unsettled}, 0U) << tick;
        if (tick % 10 == 0) deepest = std::max(deepest, deepest_sphere(model, result));
    }
    EXPECT_LT(deepest, 0.01);
    // Corners of 1 mm around a middle that is 15 mm deep: the slot of 3 mm lets it turn by some 4 degrees.
    const double turn =
        rotation_between(Quaterniond::Identity(), quaternion_of(result.tool_orientation)).norm();
    EXPECT_GT(turn * 180 / std::numbers::pi, 2);
    EXPECT_LT(turn * 180 / std::numbers::pi, 8);
    EXPECT_GT(std::abs(torque_of(result).y()), 100);
}

TEST(Instrument, inside_a_body_feels_nothing_until_all_of_it_was_clear) {
    HapticModel model(plate_and_bar());
    TickResult result{};
    for (const double z : {-1.0, -0.5, -1.0}) {
        model.tick(turned_at({0, 0, z}, Quaterniond::Identity()), result);
        EXPECT_EQ(result.status, starts_inside);
        EXPECT_EQ(result.contact_count, 0);
        EXPECT_EQ(force_of(result).norm(), 0);
        EXPECT_EQ(quaternion_of(result.tool_orientation).w(), 1);
    }
    const TickResult held = rest_at(model, turned_at({0, 0, -1}, Quaterniond::Identity()));
    EXPECT_EQ(held.status, tick_ok);
    EXPECT_NEAR(force_of(held).z(), coupling * 1, 0.01);
}

TEST(Instrument, a_tick_never_allocates) {
    Case c = soft_block_and(box({-1, -1, 0}, {1, 1, 25}), 0.3);
    c.rigid_bodies.push_back(rigid("wall", box({-20, 12, -20}, {20, 14, 20})));
    HapticModel model(c);
    TickResult result{};
    int touching = 0;
    std::size_t allocated = 0;
    {
        const AllocationTrap trap;
        for (int tick = 0; tick < 3000; ++tick) {
            const double s = 0.004 * tick;
            model.tick(turned_at({6 * std::sin(s), 11 * std::sin(0.7 * s), 3 * std::cos(s)},
                                 about(Vector3d::UnitX(), 50 * std::sin(1.3 * s))),
                       result);
            touching += result.contact_count > 0;
        }
        allocated = trap.count();
    }
    EXPECT_EQ(allocated, 0U);
    EXPECT_GT(touching, 600);
}

}  // namespace
}  // namespace palpate
