// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <utility>
#include <vector>

#include "tests/runtime/haptics/held_tool.hpp"
#include "tests/runtime/samples.hpp"

namespace palpate {
namespace {

using namespace haptics;
using Eigen::Vector3d;

// mm: the residual that counts as solved, and the god-object's skin
constexpr double solved = 1e-3 + 2 * GodObject::skin;
constexpr double noticed = 0.1;  // mm

// Pushes a tool of 1 mm from outside, at x = -8 mm, into a gap, about and through what bounds it; the force
// is finite and, without friction, at most that of the coupling over the way to where the tool would be if
// nothing gave way; where that is far off, there is some.
// Where a rigid body bounds the gap, the tool stays out of it. Returns how many ticks touched.
int push_into(const Case& c, const Vector3d& entrance, double spread) {
    HapticModel model(c);
    std::vector<const collision::CollisionSurface*> surfaces;
    for (std::size_t body = 0; body < model.body_count(); ++body) surfaces.push_back(&model.surface(body));
    GodObject undeformed(c.haptics.tool_radius, surfaces.size());
    std::mt19937 generator(5);
    std::uniform_real_distribution<double> axis(-1, 1);
    TickResult result{};
    Vector3d device = entrance, goal = entrance;
    int touched = 0;
    for (int tick = 0; tick < samples_of(20000); ++tick) {
        if ((goal - device).norm() < 0.1) {
            const double x = axis(generator), y = axis(generator), z = axis(generator);
            goal = entrance + Vector3d(8 + 10 * x, 5 * y, spread * z);
        }
        const Vector3d way = goal - device;
        device += std::min(0.05, way.norm()) * way.normalized();
        model.tick(held_at(device), result);
        undeformed.move(surfaces, device);
        const double reach = (undeformed.position() - device).norm();
        EXPECT_TRUE(force_of(result).allFinite()) << tick;
        const double most =
            c.haptics.friction_at_rest > 0 ? c.haptics.max_force : model.coupling() * (reach + solved);
        EXPECT_LE(force_of(result).norm(), most) << tick;
        EXPECT_TRUE(result.contact_count > 0 || reach < noticed) << tick;
        for (std::size_t body = 0; body < model.rigid_count(); ++body) {
            const auto nearest = model.surface(body).closest_point(tool_of(result), 50);
            EXPECT_TRUE(nearest && nearest->distance >= c.haptics.tool_radius - 0.01) << tick;
            EXPECT_TRUE(model.surface(body).is_outside(tool_of(result))) << tick;
        }
        if (::testing::Test::HasFailure()) return touched;
        touched += result.contact_count > 0;
    }
    return touched;
}

TEST(Wedge, between_two_rigid_plates_a_tool_that_does_not_fit_stays_outside) {
    for (const double room : {0.5, 1.9, 2.0}) {
        Case c = plate();
        c.rigid_bodies.push_back(rigid("lid", box({-20, -20, room}, {20, 20, room + 10})));
        EXPECT_GT(push_into(c, {-28, 0.3, room / 2}, 3), samples_of(5000)) << room;
    }
}

TEST(Wedge, that_narrows_stops_the_tool_where_it_fits_no_more) {
    Case c = plate();
    TriangleMesh lid = box({-20, -20, 0}, {20, 20, 10});
    for (Vector3d& v : lid.vertices) v.z() += 0.1 + 0.1 * (20 - v.x());  // from 4.1 to 0.1 mm of room
    c.rigid_bodies.push_back(rigid("lid", lid));
    EXPECT_GT(push_into(c, {-4, 0.3, 1.2}, 3), samples_of(5000));
}

TEST(Wedge, between_a_rigid_plate_and_the_fixed_side_of_tissue_keeps_forces_finite) {
    for (const double room : {0.5, 1.5, 1.99}) {
        Case c = soft_cube(3);
        c.rigid_bodies.push_back(rigid("floor", box({-10, -10, -room - 10}, {30, 30, -room})));
        EXPECT_GT(push_into(c, {-8, 9.3, 1.1 - room}, 3), samples_of(5000)) << room;
    }
}

TEST(Wedge, between_a_rigid_plate_and_soft_tissue_lets_the_tissue_give_way) {
    for (const double room : {0.5, 1.5, 1.99}) {
        Case c = soft_cube(3);
        c.rigid_bodies.push_back(rigid("lid", box({-2, -10, 20 + room}, {30, 30, 30 + room})));
        EXPECT_GT(push_into(c, {-8, 9.3, 20 + room / 2}, 3), samples_of(5000)) << room;
    }
}

// What tissue drags along must not go into bone.
TEST(Wedge, between_bone_and_tissue_that_rub_keeps_the_tool_out_of_bone) {
    for (const double room : {0.5, 1.5, 1.99}) {
        Case c = soft_cube(3);
        c.haptics.friction_at_rest = c.haptics.friction_sliding = 0.4;
        c.rigid_bodies.push_back(rigid("lid", box({-2, -10, 20 + room}, {30, 30, 30 + room})));
        c.rigid_bodies.push_back(rigid("post", box({-6, -10, 0}, {-5, 4, 40})));
        EXPECT_GT(push_into(c, {-8, 9.3, 20 + room / 2}, 3), samples_of(5000)) << room;
    }
}

// A bone bent like a coarse ball hangs over soft tissue; a tool that is pressed into the tissue goes round in
// circles under its flank, there and back. Bone and tissue give back what the hand put in.
TEST(Wedge, between_bent_bone_and_tissue_gives_back_what_a_closed_way_took) {
    Case c = soft_cube(6);
    c.rigid_bodies.push_back(rigid("knob", sample::sphere_surface({10, 12, 26}, 6, 1)));
    constexpr double speed = 0.01, pi = 3.14159265358979;  // mm a tick
    for (const auto& [x, z] : {std::pair(11.0, 19.5), std::pair(12.0, 20.0)}) {
        HapticModel model(c);
        TickResult result{};
        Vector3d device(x, 3, 24), force = Vector3d::Zero();
        double work = 0, stored = 0;
        int between = 0;  // ticks
        const auto go = [&](const Vector3d& to) {
            const Vector3d from = device;
            const int ticks = static_cast<int>(std::ceil((to - from).norm() / speed));
            for (int tick = 1; tick <= ticks; ++tick) {
                const Vector3d last = device, last_force = force;
                device = from + (to - from) * tick / ticks;
                model.tick(held_at(device), result);
                EXPECT_EQ(result.status, tick_ok) << device.transpose();
                force = force_of(result);
                const auto presses = [&](std::int32_t body) {
                    return std::ranges::any_of(result.active_contacts(), [&](const Contact& contact) {
                        return contact.body == body && contact.force > 0;
                    });
                };
                between += presses(0) && presses(1);
                const auto bone = model.surface(0).closest_point(tool_of(result), 50);
                EXPECT_TRUE(bone && bone->distance >= c.haptics.tool_radius - 0.01) << tick;
                work += (force + last_force).dot(device - last) / 2;
                stored = std::max(stored, -work);
            }
        };
        model.tick(held_at(device), result);
        go({x, 3, z});
        go({x, 6, z});
        for (const double turns : {1.0, -1.0}) {
            const double before = work;
            for (int k = 1; k <= 72; ++k) {
                const double angle = turns * 2 * pi * k / 72;
                go({x - 3 * std::sin(angle), 9 - 3 * std::cos(angle), z});
            }
            EXPECT_LT(std::abs(work - before), 0.005 * stored) << x;
        }
        EXPECT_GT(between, 100);
    }
}

// A bar lies over tissue that keeps a tool on a weak coupling in front of it, while its device goes beneath
// and comes up behind. Once tissue lets go, the bar still holds the tool where it is.
TEST(Wedge, what_tissue_lets_go_of_stays_on_its_side_of_bone) {
    Case c = soft_cube(4);
    c.haptics.coupling_stiffness = 0.002;
    c.rigid_bodies.push_back(rigid("bar", box({9, -10, 20.3}, {11, 30, 40})));
    HapticModel model(c);
    TickResult result{};
    int pressed = 0;
    Vector3d device(5, 10, 24);
    const auto go = [&](const Vector3d& to) {
        for (; (to - device).norm() > 0.02; device += 0.02 * (to - device).normalized()) {
            model.tick(held_at(device), result);
            pressed += std::ranges::any_of(result.active_contacts(),
                                           [](const Contact& contact) { return contact.body == 1; });
            EXPECT_LT(tool_of(result).x(), 8.01) << device.transpose();
        }
    };
    go({5, 10, 18});
    go({15, 10, 18});
    EXPECT_GT(pressed, 100);
    go({15, 10, 26});
    EXPECT_EQ(result.contact_count, 1);
    EXPECT_LT(force_of(result).x(), -0.9 * 0.002 * 7);
}

}  // namespace
}  // namespace palpate
