// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "runtime/haptics/contact/god_object.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/runtime/haptics/held_tool.hpp"

namespace palpate {
namespace {

using namespace collision;
using namespace haptics;
using Eigen::Vector3d;

CollisionSurface collision_surface(const TriangleMesh& mesh) {
    return CollisionSurface(mesh, sample::median_tree(mesh, 4), "surface");
}

bool move(GodObject& tool, const CollisionSurface& surface, const Vector3d& device,
          const Friction& friction = {}) {
    const std::array<const CollisionSurface*, 1> surfaces{&surface};
    return tool.move(surfaces, device, friction);
}

// A closed box seen from inside: its corners and edges are concave for the tool.
TriangleMesh room(double edge) {
    TriangleMesh mesh = boundary_surface(sample::cube_mesh(4, edge)).surface;
    for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
    return mesh;
}

// A sphere with bumps of a few mm: convex and concave places of all sizes.
TriangleMesh bumpy() {
    TriangleMesh mesh = sample::sphere_surface({0, 0, 0}, 20, 3);
    for (Vector3d& v : mesh.vertices)
        v *= 1 + 0.1 * std::sin(0.5 * v.x()) * std::sin(0.4 * v.y()) * std::cos(0.3 * v.z());
    return mesh;
}

TEST(GodObject, goes_the_same_way_where_its_clearance_is_known) {
    const CollisionSurface surface = collision_surface(bumpy());
    GodObject asked(0.5, 1), told(0.5, 1);
    int known = 0, held = 0;
    for (int tick = 0; tick < 20000; ++tick) {
        const double s = 0.003 * tick;
        const Vector3d device(33 * std::sin(s), 30 * std::sin(1.31 * s + 1), 30 * std::cos(0.77 * s));
        move(asked, surface, device);
        move(told, surface, device);
        ASSERT_EQ(asked.position(), told.position()) << tick;
        ASSERT_EQ(asked.touches().size(), told.touches().size());
        known += told.is_known_clear();
        held += !told.touches().empty();
        if (!told.touches().empty() || told.is_known_clear()) continue;
        if (const auto nearest = surface.closest_point(told.position(), 20))
            told.note_clearance(nearest->distance);
    }
    EXPECT_GT(known, 4000);
    EXPECT_GT(held, 800);
}

// Over a table's top, which it is to be slightly beyond in the end, to a wall behind it.
TEST(GodObject, that_slips_past_a_surface_meets_what_lies_behind) {
    const CollisionSurface table = collision_surface(box({-2, -5, -2}, {2, 5, 0})),
                           wall = collision_surface(box({4, -5, -2}, {6, 5, 5}));
    const std::array<const CollisionSurface*, 2> surfaces{&table, &wall};
    GodObject tool(1, 2);
    tool.start_clear_at({-1.5, 0, 1.0005});
    const Vector3d to(4.5, 0, 0.9965), before_the_wall(1.5, 0, 0.9995);
    const auto first = tool.touch_on_the_way(surfaces, to);
    ASSERT_TRUE(first);
    EXPECT_EQ(first->surface, 0U);
    EXPECT_EQ(tool.touch_on_the_way(surfaces, to, 2e-3)->surface, 0U);  // 3.5 um beyond
    EXPECT_TRUE(tool.touch_on_the_way(surfaces, before_the_wall));
    EXPECT_FALSE(tool.touch_on_the_way(surfaces, before_the_wall, 2e-3));
    const auto behind = tool.touch_on_the_way(surfaces, to + Vector3d(0, 0, 0.003), 2e-3);
    ASSERT_TRUE(behind);
    EXPECT_EQ(behind->surface, 1U);
    EXPECT_LT((behind->normal - Vector3d(-1, 0, 0)).norm(), 1e-6);
    EXPECT_EQ(tool.position(), Vector3d(-1.5, 0, 1.0005));
}

TEST(GodObject, that_starts_where_it_is_clear_holds_from_the_first_move_on) {
    const CollisionSurface surface = collision_surface(bumpy());
    GodObject tool(0.5, 1);
    tool.start_clear_at({0, 0, 30});
    EXPECT_EQ(tool.position(), Vector3d(0, 0, 30));
    EXPECT_TRUE(move(tool, surface, {0, 0, -30}));
    EXPECT_GT(tool.position().z(), 15);
    EXPECT_EQ(tool.touches().size(), 1U);
}

TEST(GodObject, never_enters_a_surface_at_1000_mm_per_s) {
    const CollisionSurface surface = collision_surface(bumpy());
    for (const double radius : {0.01, 0.5, 2.0}) {
        GodObject tool(radius, 1);
        Vector3d device(0, 0, 40);
        std::mt19937 generator(9);
        std::uniform_real_distribution<double> axis(-25, 25);
        Vector3d target(axis(generator), axis(generator), axis(generator));
        ASSERT_TRUE(move(tool, surface, device));
        for (int tick = 0; tick < 5000; ++tick) {
            // 1 mm per tick from one random place to the next, through the body or along it.
            Vector3d way = target - device;
            if (way.norm() < 1) {
                target = Vector3d(axis(generator), axis(generator), axis(generator));
                way = target - device;
            }
            device += way.normalized();
            ASSERT_TRUE(move(tool, surface, device));
            ASSERT_TRUE(surface.is_outside(tool.position())) << tick;
            const auto nearest = surface.closest_point(tool.position(), 100);
            ASSERT_GE(nearest->distance, radius - 1e-9) << tick;  // rounding of the sweep
        }
    }
}

TEST(GodObject, rests_at_the_nearest_place_on_a_sphere) {
    // On a fine sphere the resting place lies straight above the device.
    const CollisionSurface surface = collision_surface(sample::sphere_surface({0, 0, 0}, 20, 5));
    GodObject tool(1, 1);
    ASSERT_TRUE(move(tool, surface, {0, 0, 25}));
    for (int tick = 0; tick < 2000; ++tick) {
        const double angle = 1e-3 * tick;
        const Vector3d up(std::sin(angle), 0.3 * std::sin(angle), std::cos(angle));
        move(tool, surface, 19 * up.normalized());
        ASSERT_FALSE(tool.touches().empty());
        // Facets are 2 degrees wide: the foot may lie off by their size times the sag.
        EXPECT_NEAR((tool.position() - 21 * up.normalized()).norm(), 0, 0.2) << tick;
    }
}

TEST(GodObject, slides_into_the_corner_of_a_room_and_rests_on_three_walls) {
    const CollisionSurface surface = collision_surface(room(20));
    GodObject tool(1, 1);
    ASSERT_TRUE(move(tool, surface, {10, 10, 10}));
    move(tool, surface, {-3, -4, -5});
    EXPECT_NEAR((tool.position() - Vector3d(1, 1, 1)).norm(), 0, 5 * GodObject::skin);
    EXPECT_EQ(tool.touches().size(), 3U);
    move(tool, surface, {10, 10, 10});
    EXPECT_EQ((tool.position() - Vector3d(10, 10, 10)).norm(), 0);
    EXPECT_TRUE(tool.touches().empty());
}

TEST(GodObject, slides_without_friction) {
    // Over a flat floor the tool stays exactly above the device.
    const CollisionSurface surface = collision_surface(room(20));
    GodObject tool(1, 1);
    ASSERT_TRUE(move(tool, surface, {5, 5, 5}));
    for (int tick = 0; tick < 1000; ++tick) {
        const Vector3d device(5 + 0.01 * tick, 5 + 0.004 * tick, -2);
        move(tool, surface, device);
        EXPECT_NEAR((tool.position() - Vector3d(device.x(), device.y(), 1)).norm(), 0, 2 * GodObject::skin);
        EXPECT_EQ(tool.touches().size(), 1U);
    }
}

TEST(GodObject, turns_over_edges_within_some_ticks_and_settles) {
    // Below the edges of a coarse ball the nearest place jumps by depth * sin(dihedral), here 1 to 2 mm.
    const CollisionSurface surface = collision_surface(sample::sphere_surface({0, 0, 0}, 20, 1));
    GodObject tool(1, 1);
    ASSERT_TRUE(move(tool, surface, {0, 0, 25}));
    const auto hand = [](int tick) -> Vector3d {
        return 15 * Vector3d(std::sin(4e-3 * tick), 0.2, std::cos(4e-3 * tick));
    };
    for (int tick = 0; tick < 30; ++tick) move(tool, surface, hand(0));
    Vector3d last = tool.position();
    double longest = 0;
    for (int tick = 1; tick < 1500; ++tick) {
        move(tool, surface, hand(tick));
        longest = std::max(longest, (tool.position() - last).norm());
        last = tool.position();
    }
    // The hand moves 0.06 mm a tick; letting the tool down behind an edge adds to the slide.
    EXPECT_LE(longest, 2 * 0.06 + GodObject::slide_slack + 0.15);
    for (int tick = 0; tick < 100; ++tick) move(tool, surface, hand(1500));
    last = tool.position();
    move(tool, surface, hand(1500));
    EXPECT_LE((tool.position() - last).norm(), 1e-5);
}

TEST(GodObject, is_not_felt_until_it_was_clear_of_the_surface) {
    const CollisionSurface surface = collision_surface(sample::sphere_surface({0, 0, 0}, 20, 3));
    GodObject tool(1, 1);
    EXPECT_FALSE(move(tool, surface, {0, 0, 0}));
    EXPECT_FALSE(move(tool, surface, {0, 0, 20.5}));
    EXPECT_TRUE(move(tool, surface, {0, 0, 22}));
    EXPECT_TRUE(move(tool, surface, {0, 0, 18}));
    EXPECT_NEAR(tool.position().z(), 21, 0.1);
    tool.reset();
    EXPECT_FALSE(move(tool, surface, {0, 0, 18}));
}

}  // namespace
}  // namespace palpate
