// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <memory>
#include <vector>

#include "tests/runtime/allocation_trap.hpp"
#include "tests/runtime/haptics/equilibrium_oracle.hpp"
#include "tests/runtime/haptics/held_tool.hpp"
#include "tests/runtime/samples.hpp"

namespace palpate {
namespace {

using namespace haptics;
using namespace realtime;
using Eigen::Vector3d;

constexpr double tool_skins = 2 * GodObject::skin;
constexpr double single = 1e-5;  // relative: records and compliance are float32
constexpr int settling = 30;     // ticks; what one tool moves, the other feels a tick later

Case cube_for_tools(int cells, double radius) {
    Case c = soft_cube(cells);
    c.haptics.tool_radius = radius;
    return c;
}

// Some tools that come down from `above` mm higher and stay.
std::vector<TickResult> press(const Case& c, const std::vector<DeviceState>& devices, double above = 8) {
    HapticModel model(c, "continuous", devices.size());
    std::vector<TickResult> results(devices.size());
    std::vector<DeviceState> higher = devices;
    for (DeviceState& device : higher) device.position[2] += above;
    model.tick(higher, results);
    for (int tick = 0; tick < settling; ++tick) model.tick(devices, results);
    return results;
}

TEST(TwoTools, rest_together_on_the_surface_that_the_whole_stiffness_displaces) {
    const Case c = cube_for_tools(5, 3);
    const EquilibriumOracle oracle(c.deformable_bodies[0]);
    for (const Vector3d& second : {Vector3d(16, 15, 22), Vector3d(13.5, 11.5, 21), Vector3d(21.5, 10, 10)}) {
        const auto results = press(c, {held_at({6.3, 7.4, 21}), held_at(second)}, 15);
        for (std::size_t t = 0; t < 2; ++t) {
            EXPECT_EQ(results[t].tool, static_cast<int>(t));
            EXPECT_EQ(results[t].status, tick_ok);
            ASSERT_GT(press_of(results[t]), 0.003) << second.transpose();
        }
        oracle.expect_equilibrium(results, 3, c.haptics.coupling_stiffness, 2e-3);
    }
}

TEST(TwoTools, each_feels_less_in_the_dent_of_the_other) {
    const Case c = cube_for_tools(5, 3);
    const DeviceState deep = held_at({8, 10, 19.5}), shallow = held_at({14.2, 10, 22});
    const double deep_alone = force_of(press(c, {deep})[0]).z();
    const double shallow_alone = force_of(press(c, {shallow})[0]).z();
    const auto both = press(c, {deep, shallow});
    ASSERT_GT(shallow_alone, 0.01);
    EXPECT_LT(force_of(both[1]).z(), 0.9 * shallow_alone);
    EXPECT_GE(force_of(both[1]).z(), 0);
    EXPECT_LE(force_of(both[0]).z(), deep_alone * (1 + single));
    // Pressed alike, both give way to each other.
    const DeviceState beside = held_at({14.2, 10, 19.5});
    const auto alike = press(c, {deep, beside});
    EXPECT_LT(force_of(alike[0]).z(), 0.98 * deep_alone);
    EXPECT_LT(force_of(alike[1]).z(), 0.98 * force_of(press(c, {beside})[0]).z());
}

TEST(TwoTools, touch_nothing_where_the_other_has_pushed_it_away) {
    const Case c = cube_for_tools(5, 3);
    const DeviceState deep = held_at({8, 10, 19}), shallow = held_at({10.5, 10, 22.9});
    EXPECT_GT(press(c, {shallow})[0].contact_count, 0);
    const TickResult beside = press(c, {deep, shallow})[1];
    EXPECT_EQ(beside.contact_count, 0);
    EXPECT_EQ(beside.body, -1);
    EXPECT_EQ(force_of(beside).norm(), 0);
}

TEST(TwoTools, that_touch_different_bodies_feel_what_each_feels_alone) {
    constexpr double settled = 1e-4;  // mm: at changes below it a search ends, of all tools at once
    Case c = cube_for_tools(3, 2);
    c.deformable_bodies.push_back(moved(c.deformable_bodies[0], {50, 3, 0}));
    c.deformable_bodies[1].name = "other cube";
    c.rigid_bodies.push_back(rigid("plate", box({-60, -20, -10}, {-20, 20, 0})));
    const DeviceState first = held_at({9, 8, 20}), second = held_at({61, 14, 20.5}),
                      third = held_at({-40, 2, 1});
    const auto both = press(c, {first, second, third});
    const std::array alone{press(c, {first})[0], press(c, {second})[0], press(c, {third})[0]};
    for (std::size_t t = 0; t < 3; ++t) {
        ASSERT_GT(force_of(alone[t]).norm(), 0.01);
        EXPECT_NEAR((force_of(both[t]) - force_of(alone[t])).norm(), 0,
                    settled * c.haptics.coupling_stiffness);
        EXPECT_EQ(both[t].body, alone[t].body);
    }
}

TEST(TwoTools, pressed_symmetrically_feel_symmetric_forces) {
    // The cube's tetrahedra stay the same when x and y change places.
    const Case c = cube_for_tools(4, 2);
    for (const double apart : {3.0, 6.0}) {
        const auto results =
            press(c, {held_at({10.5 - apart, 9.5 + apart, 20}), held_at({9.5 + apart, 10.5 - apart, 20})});
        const Vector3d left = force_of(results[0]), right = force_of(results[1]);
        ASSERT_GT(left.norm(), 0.01);
        EXPECT_NEAR((Vector3d(left.y(), left.x(), left.z()) - right).norm(), 0, 10 * single * left.norm());
    }
}

TEST(TwoTools, given_in_another_order_feel_the_same) {
    const Case c = cube_for_tools(4, 2);
    const DeviceState a = held_at({7, 9, 20}), b = held_at({12, 10, 20.5});
    const auto one_way = press(c, {a, b}), other_way = press(c, {b, a});
    for (std::size_t t = 0; t < 2; ++t) {
        const Vector3d force = force_of(one_way[t]);
        ASSERT_GT(force.norm(), 0.01);
        EXPECT_NEAR((force - force_of(other_way[1 - t])).norm(), 0, 10 * single * force.norm());
        EXPECT_EQ(other_way[t].tool, static_cast<int>(t));
    }
}

Case with_shaft(Case c, double length = 30) {
    c.haptics.shaft_length = length;
    return c;
}

TEST(Shaft, laid_on_a_plate_is_held_although_the_tip_is_beyond_it) {
    const Case c = with_shaft(plate());
    for (const double depth : {0.1, 0.5}) {
        const Vector3d tip(28, 0.3, 1 - depth);
        const TickResult held = press(c, {held_at(tip, {-1, 0, 0})})[0];
        // All spheres rest on one plane: together as stiff as the coupling.
        EXPECT_NEAR((force_of(held) - Vector3d(0, 0, 0.5 * depth)).norm(), 0, tool_skins) << depth;
        EXPECT_EQ(held.body, 0);
        for (const Contact& contact : held.active_contacts()) EXPECT_GE(contact.part, 8);  // beyond 8 mm
        EXPECT_EQ(force_of(press(c, {held_at(tip)})[0]).norm(), 0);
        EXPECT_EQ(force_of(press(c, {held_at(tip, {1, 0, 0})})[0]).norm(), 0);
        EXPECT_EQ(force_of(press(plate(), {held_at(tip, {-1, 0, 0})})[0]).norm(), 0);
    }
}

TEST(Shaft, laid_over_soft_tissue_is_held_although_the_tip_is_beyond_it) {
    const Case c = with_shaft(cube_for_tools(4, 2));
    const Vector3d tip(28, 9.3, 21);
    const TickResult held = press(c, {held_at(tip, {-1, 0, 0})})[0];
    EXPECT_GT(force_of(held).z(), 0.01);
    EXPECT_LE(force_of(held).norm(), 0.5 * (1 + tool_skins));  // 1 mm on 0.5 N/mm
    EXPECT_FALSE(held.status & contact_unsolved);
    EXPECT_EQ(force_of(press(c, {held_at(tip)})[0]).norm(), 0);
    // It lies on more tissue than a tip does.
    const Vector3d on_top(10, 9.3, 21);
    EXPECT_GT(force_of(held).z(), force_of(press(c, {held_at(on_top)})[0]).z());
}

// A shaft of 10 mm that wanders over a plate, tilted by as much as `tilt_at` says at t, in s. Returns how
// many ticks touched.
template <typename Tilt>
int wander_on_plate(const Tilt& tilt_at, bool tissue_elsewhere = false) {
    // mm: what a god-object leaves of a way for the next tick.
    constexpr double settled = 0.01;
    Case c = with_shaft(plate(), 10);
    if (tissue_elsewhere) c.deformable_bodies.push_back(moved(sample::true_elastic_cube(2), {100, 0, 0}));
    HapticModel model(c);
    TickResult result{};
    model.tick(held_at({0, 0, 30}, {0, 0, 1}), result);
    int touched = 0;
    for (int tick = 0; tick < 4000; ++tick) {
        const double t = 1e-3 * tick, tilt = tilt_at(t);
        const Vector3d tip(5 * std::sin(t), 5 * std::cos(1.3 * t), 1.5 + 2 * std::sin(3 * t));
        const Vector3d shaft(std::cos(tilt) * std::cos(t), std::cos(tilt) * std::sin(t), std::sin(tilt));
        model.tick(held_at(tip, shaft), result);
        // Points of one normal share one coupling, so the deepest bears all.
        const double deepest = std::max(1 - tip.z(), 1 - (tip + 10 * shaft).z());
        const Vector3d expected(0, 0, 0.5 * std::max(0.0, deepest));
        EXPECT_NEAR((force_of(result) - expected).norm(), 0, 0.5 * settled) << tick;
        EXPECT_GE(force_of(result).z(), 0);
        EXPECT_EQ(result.status, tick_ok) << tick;
        if (::testing::Test::HasFailure()) return touched;
        touched += deepest > 0;
    }
    return touched;
}

TEST(Shaft, on_a_plate_presses_with_its_deepest_place_and_never_pulls) {
    for (const bool tissue_elsewhere : {false, true}) {
        EXPECT_GT(wander_on_plate([](double) { return -0.1; }, tissue_elsewhere), 1000);
        EXPECT_GT(wander_on_plate([](double) { return 0.1; }, tissue_elsewhere), 1000);
        EXPECT_GT(wander_on_plate([](double t) { return 0.3 * std::sin(7 * t); }, tissue_elsewhere), 1000);
    }
}

// Nothing gives way here, so nothing but the coupling decides: a press of 2 mm, near the origin of the frame.
TEST(Shaft, is_held_wherever_the_plate_is) {
    Case c = with_shaft(plate(), 1);
    c.rigid_bodies[0] = rigid("plate", box({-20, -20, -10}, {20, 20, 1}));
    for (const double x : {0.0, 15.0})
        EXPECT_NEAR(force_of(press(c, {held_at({x, 0, 0}, {1, 0, 0})})[0]).z(), 0.5 * 2, tool_skins) << x;
}

TEST(Shaft, away_from_the_body_changes_nothing) {
    const Vector3d up(0.6, 0, 0.8);
    // The next sphere is 0.8 mm higher than the tip, which goes 0.7 mm deep.
    for (const Case& c : {plate(), cube_for_tools(4, 1)}) {
        const double top = c.rigid_bodies.empty() ? 20 : 0;
        HapticModel tip_only(c), with(with_shaft(c));
        TickResult expected{}, result{};
        int touched = 0;
        for (int tick = 0; tick < 2000; ++tick) {
            const Vector3d device(8 + 3 * std::sin(0.002 * tick), 9, top + 1 + 0.7 * std::cos(0.01 * tick));
            tip_only.tick(held_at(device), expected);
            with.tick(held_at(device, up), result);
            ASSERT_EQ(result.force, expected.force) << tick;
            ASSERT_EQ(result.contact_count, expected.contact_count);
            touched += result.contact_count > 0;
        }
        EXPECT_GT(touched, 500);
    }
}

// A way that nobody saw says nothing about what lies between.
TEST(Shaft, whose_direction_comes_back_beyond_a_plate_is_not_held_by_it) {
    HapticModel model(with_shaft(plate()));
    TickResult result{};
    const Vector3d along(-1, 0, 0);
    model.tick(held_at({40, 0, 5}, along), result);
    for (double z = 5; z > -15; z -= 0.5) model.tick(held_at({40, 0, z}), result);
    model.tick(held_at({40, 0, -15}, along), result);
    EXPECT_EQ(force_of(result).norm(), 0);
    // From there it feels the plate's other side.
    for (double z = -15; z < -10.6; z += 0.1) model.tick(held_at({40, 0, z}, along), result);
    EXPECT_LT(force_of(result).z(), -0.1);
}

// A tool of five elements meets more of the tissue than can be solved; the wall beside it holds all the same.
TEST(LargeTool, is_held_by_the_wall_beside_fine_tissue) {
    Case c = cube_for_tools(6, 17);  // edges of 3.3 mm
    c.rigid_bodies.push_back(rigid("wall", box({26, -30, 22}, {40, 50, 80})));
    HapticModel model(c);
    TickResult result{};
    for (double z = 42; z > 33; z -= 0.1) model.tick(held_at({8.9, 10.2, z}), result);
    for (double x = 8.9; x < 10.4; x += 0.05) model.tick(held_at({x, 10.2, 33}), result);
    for (int tick = 0; tick < settling; ++tick) model.tick(held_at({10.4, 10.2, 33}), result);
    // 10.4 mm + 17 mm of radius is 1.4 mm beyond the wall's face; the tissue pushes a little along it.
    EXPECT_LT(force_of(result).x(), -0.9 * 1.4 * c.haptics.coupling_stiffness);
    EXPECT_LT(tool_of(result).x() + 17, 26.01);
    EXPECT_GT(force_of(result).z(), 0.05);
}

// A ball far larger than the cube that comes at once presses more triangles than a tick solves: it says so,
// the wall beside bears all that is beyond it, and the tissue nearly what it bears of a ball that came
// slowly; the next ticks make up for the rest.
TEST(LargeTool, says_where_contacts_are_cut_and_is_held_by_wall_and_tissue) {
    Case c = cube_for_tools(8, 45);
    c.haptics.coupling_stiffness = 2;
    c.rigid_bodies.push_back(rigid("wall", box({60, -80, 45}, {75, 100, 120})));
    HapticModel slow(c), sudden(c);
    TickResult result{};
    for (double z = 68; z > 56; z -= 0.2) slow.tick(held_at({14, 10.2, z}), result);
    for (double x = 14; x < 15.6; x += 0.07) slow.tick(held_at({x, 10.2, 56}), result);
    for (int tick = 0; tick < settling; ++tick) slow.tick(held_at({15.6, 10.2, 56}), result);
    const Vector3d slowly = force_of(result);
    EXPECT_NEAR(slowly.x(), -2 * 0.6, 0.01);
    EXPECT_GT(slowly.z(), 0.5);
    sudden.tick(held_at({14, 10.2, 68}), result);
    sudden.tick(held_at({15.6, 10.2, 56}), result);
    EXPECT_TRUE(result.status & contacts_cut);
    EXPECT_NEAR(force_of(result).x(), slowly.x(), 1e-3);
    EXPECT_NEAR(force_of(result).z(), slowly.z(), 0.1 * slowly.z());
    for (int tick = 0; tick < settling; ++tick) sudden.tick(held_at({15.6, 10.2, 56}), result);
    EXPECT_EQ(result.status, tick_ok);
    EXPECT_LT((force_of(result) - slowly).norm(), 1e-3 * slowly.norm());
}

// A long thin shaft lies on tissue in more places than can be solved at once; that takes neither the wall
// beside it nor the other tool their share.
TEST(TwoTools, keep_their_walls_and_their_share_where_contacts_are_too_many) {
    Case c = with_shaft(cube_for_tools(6, 0.4), 18);
    c.rigid_bodies.push_back(rigid("wall", box({-5, 12, 10}, {25, 16, 40})));
    const DeviceState beside = held_at({10.3, 4.4, 19.4});
    const double alone = force_of(press(c, {beside})[0]).z();
    HapticModel model(c, "continuous", 2);
    std::array<TickResult, 2> both{};
    const auto go = [&](double y, double z) {
        model.tick(std::array{held_at({1, y, z}, {1, 0, 0}), held_at({10.3, 4.4, z})}, both);
    };
    for (double z = 24; z > 19.4; z -= 0.1) go(9, z);
    for (double y = 9; y < 11.9; y += 0.1) go(y, 19.4);
    for (int tick = 0; tick < settling; ++tick) go(11.9, 19.4);
    ASSERT_GT(both[0].contact_count + both[1].contact_count, 30);
    // 11.9 mm + 0.4 mm of radius is 0.3 mm beyond the wall's face.
    EXPECT_NEAR(force_of(both[0]).y(), -0.3 * c.haptics.coupling_stiffness, 0.01);
    EXPECT_GT(force_of(both[0]).z(), 0.01);
    ASSERT_GT(alone, 0.001);
    EXPECT_GT(force_of(both[1]).z(), 0.5 * alone);
}

// Two tools that wander over, into and beside a soft cube and a plate beneath, their shafts turning.
std::array<DeviceState, 2> two_wandering(int tick) {
    const double t = 1e-3 * tick;
    const Vector3d first(10 + 11 * std::sin(1.7 * t), 10 + 8 * std::sin(2.3 * t + 1),
                         22 + 5 * std::cos(5.1 * t));
    const Vector3d second(12 + 12 * std::cos(1.1 * t), 9 + 9 * std::sin(1.9 * t), 23 + 5 * std::cos(4.3 * t));
    const Vector3d shaft(std::cos(0.9 * t), std::sin(0.9 * t), 0.6);
    std::array devices{held_at(first, shaft.normalized()), held_at(second)};
    if (tick % 4000 < 3000) devices[1] = held_at(second, Vector3d(0, -1, 0.2).normalized());
    return devices;
}

Case all_at_once(double friction) {
    Case c = with_shaft(cube_for_tools(3, 1.5), 12);
    c.haptics.friction_at_rest = friction;
    c.haptics.friction_sliding = 0.7 * friction;
    c.haptics.max_force = 3;
    c.haptics.max_force_rate = 0.5;
    c.rigid_bodies.push_back(rigid("plate", box({-20, -20, 19}, {-1, 40, 21})));
    return c;
}

TEST(TwoTools, with_shafts_and_friction_never_allocate_in_a_tick) {
    const auto model = std::make_unique<HapticModel>(all_at_once(0.3), "continuous", 2);
    std::array<TickResult, 2> results{};
    model->tick(std::array{held_at({10, 10, 60}), held_at({20, 10, 60})}, results);
    int touching = 0;
    std::size_t allocated = 0;
    {
        const AllocationTrap trap;
        for (int tick = 0; tick < samples_of(20000); ++tick) {
            model->tick(two_wandering(tick), results);
            touching += results[0].contact_count > 0 && results[1].contact_count > 0;
        }
        allocated = trap.count();
    }
    EXPECT_EQ(allocated, 0U);
    EXPECT_GT(touching, samples_of(1500));
}

TEST(TwoTools, are_never_pulled_by_what_they_touch) {
    HapticModel model(all_at_once(0), "continuous", 2);
    std::array<TickResult, 2> results{};
    model.tick(std::array{held_at({10, 10, 60}), held_at({20, 10, 60})}, results);
    int unsolved = 0;
    for (int tick = 0; tick < samples_of(20000); ++tick) {
        model.tick(two_wandering(tick), results);
        for (const TickResult& result : results) {
            ASSERT_TRUE(force_of(result).allFinite()) << tick;
            for (const Contact& contact : result.active_contacts()) ASSERT_GE(contact.force, 0) << tick;
            unsolved += (result.status & contact_unsolved) != 0;
        }
    }
    RecordProperty("unsolved", unsolved);
    EXPECT_LT(unsolved, samples_of(400));  // 1 %
}

using Record = std::vector<std::array<TickResult, 2>>;

constexpr int ticks = samples_of(2000);

Record wander_through(HapticModel& model, int count) {
    Record record;
    std::array<TickResult, 2> results{};
    model.tick(std::array{held_at({10, 10, 60}), held_at({20, 10, 60})}, results);
    for (int tick = 0; tick < count; ++tick) {
        model.tick(two_wandering(tick), results);
        record.push_back(results);
    }
    return record;
}

void expect_same_bits(const Record& a, const Record& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t tick = 0; tick < a.size(); ++tick)
        for (std::size_t t = 0; t < 2; ++t) {
            const TickResult &x = a[tick][t], &y = b[tick][t];
            ASSERT_EQ(x.force, y.force) << tick;
            ASSERT_EQ(x.status, y.status) << tick;
            ASSERT_EQ(x.contact_count, y.contact_count) << tick;
            static_assert(sizeof(Contact) % sizeof(float) == 0 && alignof(Contact) == alignof(float));
            ASSERT_EQ(std::memcmp(x.contacts.data(), y.contacts.data(), x.active_contacts().size_bytes()), 0)
                << tick;
        }
}

TEST(TwoTools, repeat_the_same_bits_on_the_same_way) {
    HapticModel first(all_at_once(0.3), "continuous", 2), second(all_at_once(0.3), "continuous", 2);
    const Record expected = wander_through(first, ticks);
    expect_same_bits(wander_through(second, ticks), expected);
}

TEST(TwoTools, repeat_the_same_bits_after_a_reset) {
    HapticModel model(all_at_once(0.3), "continuous", 2);
    const Record expected = wander_through(model, ticks);
    for (const int before : {ticks, 150, 700, 1234, 2100, 3333}) {  // in contact or not
        model.reset();
        wander_through(model, before);
        model.reset();
        expect_same_bits(wander_through(model, ticks), expected);
    }
}

}  // namespace
}  // namespace palpate
