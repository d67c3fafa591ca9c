// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "tests/runtime/haptics/held_tool.hpp"

namespace palpate {
namespace {

using namespace haptics;
using Eigen::Vector3d;

constexpr Friction dry{.at_rest = 0.6, .sliding = 0.4};
constexpr double exact = 1e-9;  // mm: rounding of the sweep
constexpr double skins = 2 * GodObject::skin;
// Ticks until the slack of a slide has let a tool go from rest to sliding, pressed 1 mm.
constexpr int slipping = static_cast<int>((dry.at_rest - dry.sliding) / GodObject::slide_slack) + 2;

Case with_friction(Case c, const Friction& friction = dry) {
    c.haptics.friction_at_rest = friction.at_rest;
    c.haptics.friction_sliding = friction.sliding;
    return c;
}

// A god-object of 1 mm that rests on the plate above (x, 0), pressed `depth` in.
class OnPlate : public ::testing::Test {
  protected:
    OnPlate() : model_(plate()), tool_(1, 1) {}

    const Vector3d& move(double x, double depth, const Friction& friction = dry) {
        const std::array<const collision::CollisionSurface*, 1> surfaces{&model_.surface(0)};
        tool_.move(surfaces, {x, 0.1, 1 - depth}, friction);
        return tool_.position();
    }

    HapticModel model_;
    GodObject tool_;
};

TEST_F(OnPlate, a_tool_sticks_while_the_drag_is_at_most_that_at_rest) {
    move(0, -3);
    const Vector3d start = move(0, 1);
    EXPECT_NEAR(start.z(), 1, skins);
    for (int tick = 0; tick <= 1000; ++tick) {
        const double x = dry.at_rest * std::sin(0.01 * tick);
        EXPECT_NEAR((move(x, 1) - start).norm(), 0, exact) << tick;
        EXPECT_NEAR(tool_.held_back().x(), x, skins);
    }
    // The harder the press, the more it holds.
    EXPECT_NEAR((move(dry.at_rest * 1.9, 2) - start).norm(), 0, exact);
}

TEST_F(OnPlate, a_tool_slips_beyond_and_then_drags_with_the_sliding_coefficient) {
    move(0, -3);
    move(0, 1);
    move(dry.at_rest - 10 * skins, 1);
    EXPECT_NEAR(tool_.position().x(), 0, exact);
    for (int tick = 1; tick < 500; ++tick) {
        const double x = dry.at_rest + 10 * skins + 0.01 * tick;
        move(x, 1);
        if (tick < slipping) continue;
        // Wherever the hand goes on, the tool lags by the sliding coefficient of the press.
        EXPECT_NEAR(tool_.position().x(), x - dry.sliding * 1, skins) << tick;
        EXPECT_NEAR(tool_.held_back().x(), dry.sliding * 1, skins) << tick;
    }
}

TEST_F(OnPlate, a_tool_stops_again_when_the_hand_turns_back) {
    move(0, -3);
    move(0, 1);
    for (int tick = 1; tick <= 300; ++tick) move(0.01 * tick, 1);
    const Vector3d stopped = tool_.position();
    EXPECT_GT(stopped.x(), 2);
    // From a lag of `sliding` before to one of `at_rest` behind.
    const double way_back = dry.sliding + dry.at_rest;
    for (double back = 0.01; back < way_back - 0.01; back += 0.01)
        EXPECT_NEAR((move(3 - back, 1) - stopped).norm(), 0, exact) << back;
    move(3 - way_back - 0.01, 1);
    EXPECT_LT(tool_.position().x(), stopped.x() - 0.1);
}

TEST_F(OnPlate, a_tool_let_go_is_held_no_more) {
    move(0, -3);
    move(0, 1);
    move(0.5, 1);
    EXPECT_NEAR(tool_.position().x(), 0, exact);
    move(0.5, 0.5);  // holds 0.6 * 0.5 only
    EXPECT_NEAR(tool_.position().x(), 0.5 - dry.sliding * 0.5, skins);
    move(0.5, -1);
    EXPECT_EQ(tool_.position(), Vector3d(0.5, 0.1, 2));
    EXPECT_EQ(tool_.held_back().norm(), 0);
}

TEST_F(OnPlate, without_friction_nothing_is_held_back) {
    move(0, -3, {});
    for (int tick = 0; tick < 300; ++tick) {
        move(0.01 * tick, 1, {});
        EXPECT_NEAR(tool_.position().x(), 0.01 * tick, exact);
        EXPECT_EQ(tool_.held_back().norm(), 0);
    }
}

TEST(Friction, drags_a_tool_on_a_rigid_plate_by_coulombs_law) {
    HapticModel model(with_friction(plate()));
    TickResult result{};
    model.tick(held_at({0, 0, 4}), result);
    model.tick(held_at({0, 0, 0}), result);
    double last = 0;
    int slid = 0;
    for (int tick = 1; tick < 400; ++tick) {
        const Vector3d device(0.008 * tick, 0.006 * tick, 0);  // 0.01 mm a tick
        model.tick(held_at(device), result);
        const Vector3d force = force_of(result);
        const double drag = force.head<2>().norm(), press = force.z();
        EXPECT_NEAR(press, 0.5, skins);
        EXPECT_NEAR((drag_of(result) - Vector3d(force.x(), force.y(), 0)).norm(), 0, 1e-6);  // float32
        EXPECT_LE(drag, dry.at_rest * press + skins);
        EXPECT_NEAR(force.head<2>().dot(device.head<2>()), -drag * device.head<2>().norm(), skins * 10);
        if (drag < last - skins) ++slid;
        // Stuck, it pulls like the coupling.
        if (slid == 0) {
            EXPECT_NEAR(drag, 0.5 * 0.01 * tick, skins) << tick;
        }
        if (tick > 60 + slipping) {
            EXPECT_NEAR(drag, dry.sliding * press, skins) << tick;
        }
        last = drag;
    }
    EXPECT_GT(slid, 0);
    EXPECT_LE(slid, slipping);
}

// The work of the force on the hand over closed loops of the device, N mm, the force taken as linear from one
// tick to the next; a spring does none.
double work_over_loops(HapticModel& model, const Vector3d& middle, double radius, double heave) {
    TickResult result{};
    constexpr int ticks = 4000, loops = 3;
    Vector3d last_device = Vector3d::Zero(), last_force = Vector3d::Zero();
    double work = 0;
    for (int tick = -10; tick <= loops * ticks; ++tick) {
        const double angle = 2 * std::numbers::pi * std::max(0, tick) / ticks;
        Vector3d device = middle + Vector3d(radius * std::cos(angle), radius * std::sin(2 * angle),
                                            heave * std::sin(3 * angle));
        if (tick == -10) device.z() += 10;  // clear of the body first
        model.tick(held_at(device), result);
        const Vector3d force = force_of(result);
        if (tick > 0) work += 0.5 * (force + last_force).dot(device - last_device);
        last_device = device;
        last_force = force;
    }
    return work;
}

TEST(Friction, gives_no_energy_to_the_hand_over_closed_loops) {
    constexpr double spring = 2e-4;  // N mm: what a loop without friction leaves, by the skins
    for (const double radius : {0.2, 1.0, 4.0})
        for (const double heave : {0.0, 0.5, 1.3}) {  // the last one lifts off
            HapticModel rough(with_friction(plate())), smooth(plate());
            const double work = work_over_loops(rough, {0.3, 0.2, 0}, radius, heave);
            EXPECT_LE(work, spring) << radius << " " << heave;
            EXPECT_NEAR(work_over_loops(smooth, {0.3, 0.2, 0}, radius, heave), 0, spring);
            if (radius >= 1) {
                EXPECT_LT(work, -0.1);
            }
        }
}

TEST(Friction, takes_energy_from_the_hand_on_soft_tissue) {
    for (const double radius : {0.3, 2.0})
        for (const double heave : {0.0, 0.5}) {
            HapticModel rough(with_friction(soft_cube(4))), smooth(soft_cube(4));
            const double work = work_over_loops(rough, {10.3, 9.4, 19.5}, radius, heave);
            EXPECT_LT(work, work_over_loops(smooth, {10.3, 9.4, 19.5}, radius, heave))
                << radius << " " << heave;
        }
}

// A tool of 3 mm drawn over the cube's top, `depth` deep, 0.01 mm a tick; `look` gets each result.
template <typename Look>
void draw_over_cube(const Friction& friction, double depth, int ticks, const Look& look) {
    Case c = with_friction(soft_cube(4), friction);
    c.haptics.tool_radius = 3;
    HapticModel model(c);
    TickResult result{};
    model.tick(held_at({7, 9.3, 27}), result);
    for (int tick = 0; tick < 20; ++tick) model.tick(held_at({7, 9.3, 23 - depth}), result);
    for (int tick = 0; tick < ticks; ++tick) {
        model.tick(held_at({7 + 0.01 * tick, 9.3, 23 - depth}), result);
        look(tick, result);
    }
}

TEST(Friction, on_soft_tissue_is_at_most_that_at_rest_in_every_tick) {
    for (const double depth : {0.2, 1.0, 3.0})
        draw_over_cube(dry, depth, 600, [&](int tick, const TickResult& result) {
            ASSERT_GT(press_of(result), 0);
            EXPECT_EQ(result.status, tick_ok);
            // Records are in float32.
            ASSERT_LE(drag_of(result).norm(), dry.at_rest * press_of(result) * (1 + 1e-5)) << tick;
            for (const Contact& contact : result.active_contacts())
                ASSERT_LE(Eigen::Map<const Eigen::Vector3f>(contact.friction.data()).norm(),
                          static_cast<float>(dry.at_rest) * contact.force * (1 + 1e-4F) + 1e-9F);
            if (tick > 100) {                               // by then it has forgotten how the tool came down
                EXPECT_LE(drag_of(result).x(), 0) << tick;  // against the motion
            }
        });
}

TEST(Friction, on_soft_tissue_is_at_most_that_at_rest_while_the_press_trembles) {
    Case c = with_friction(soft_cube(4));
    c.haptics.tool_radius = 3;
    HapticModel model(c);
    TickResult result{};
    model.tick(held_at({7, 9.3, 27}), result);
    for (int tick = 0; tick < 1000; ++tick) {
        const double depth = 1.5 + 1.4 * std::sin(0.3 * tick);
        model.tick(held_at({10 + 4 * std::sin(0.02 * tick), 9.3, 23 - depth}), result);
        ASSERT_LE(drag_of(result).norm(), dry.at_rest * press_of(result) * (1 + 1e-5)) << tick;
    }
}

TEST(Friction, on_soft_tissue_tends_to_the_sliding_coefficient) {
    // The god-object slides by the grip of the tick before, so the ratio is off by how much the grip changes
    // in a tick, which is largest over edges of the mesh.
    constexpr double lag = 0.03, mean_lag = 0.01;
    for (const double depth : {0.5, 2.0}) {
        double sum = 0;
        int count = 0;
        draw_over_cube(dry, depth, 800, [&](int tick, const TickResult& result) {
            if (tick < 400) return;
            const double ratio = drag_of(result).norm() / press_of(result);
            EXPECT_NEAR(ratio, dry.sliding, lag) << depth << " " << tick;
            sum += ratio;
            ++count;
        });
        EXPECT_NEAR(sum / count, dry.sliding, mean_lag) << depth;
    }
}

TEST(Friction, changes_from_rest_to_sliding_by_no_more_than_the_coefficients_do) {
    // N: what the coupling alone adds as the hand moves on; what tissue lets go of may add half as much.
    constexpr double per_tick = 0.5 * 0.01;
    for (const Friction friction : {dry, Friction{0.3, 0.3}}) {
        Vector3d last = Vector3d::Zero();
        draw_over_cube(friction, 2, 800, [&](int tick, const TickResult& result) {
            const Vector3d force = force_of(result);
            const double drop = (friction.at_rest - friction.sliding) * press_of(result);
            if (tick > 0) {
                EXPECT_LE((force - last).norm(), 1.1 * drop + 1.5 * per_tick)
                    << friction.sliding << " " << tick;
            }
            last = force;
        });
    }
}

// Of the largest force, the largest change of it in a tick of 0.02 mm, on the way over the cube's edge.
double largest_step_over_edge(double coefficient, double radius, double depth) {
    Case c = with_friction(soft_cube(3), {coefficient, coefficient});
    c.haptics.tool_radius = radius;
    HapticModel model(c);
    TickResult result{};
    const double above = 20 + radius;
    for (double z = above + 1; z > above - depth; z -= 0.02) model.tick(held_at({10, 9.3, z}), result);
    Vector3d last = force_of(result);
    double step = 0, most = 0;
    for (int tick = 0; tick < 800; ++tick) {
        model.tick(held_at({10 + 0.02 * tick, 9.3, above - depth}), result);
        EXPECT_EQ(result.status, tick_ok) << coefficient << " " << depth << " " << tick;
        step = std::max(step, (force_of(result) - last).norm());
        most = std::max(most, force_of(result).norm());
        last = force_of(result);
    }
    return step / most;
}

TEST(Friction, lets_go_over_an_edge_no_more_suddenly_than_an_edge_without_it) {
    constexpr double without_a_snap = 0.05;
    for (const double radius : {1.0, 3.0})
        for (const double depth : {0.5, 1.5, 3.0}) {  // the deep ones snap off the edge
            const double smooth = largest_step_over_edge(0, radius, depth);
            for (const double coefficient : {0.4, 0.8})
                EXPECT_LE(largest_step_over_edge(coefficient, radius, depth),
                          std::max(smooth, without_a_snap))
                    << coefficient << " " << radius << " " << depth;
        }
}

}  // namespace
}  // namespace palpate
