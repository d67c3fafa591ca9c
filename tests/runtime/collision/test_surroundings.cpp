// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <vector>

#include "runtime/collision/surroundings.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/runtime/collision/collision_scene.hpp"

namespace palpate {
namespace {

using namespace collision;
using Eigen::Vector3d;

double distance_to(const CollisionSurface& surface, std::int32_t slot, const Vector3d& p) {
    return std::sqrt(closest_point_on_triangle(p, surface.corners(slot)).squared_distance);
}

// Slots that are within the room about `p`, all of which must be gathered.
void expect_complete(const CollisionSurface& surface, const Surroundings& around, const Vector3d& p,
                     double radius) {
    std::vector<std::int32_t> gathered;
    for (std::size_t at = 0; at < around.count(); ++at) gathered.push_back(around.slot(at));
    const double reach = around.room(p, radius) + radius;
    for (std::int32_t slot = 0; slot < surface.triangle_count(); ++slot)
        ASSERT_TRUE(distance_to(surface, slot, p) >= reach || std::ranges::count(gathered, slot) == 1)
            << slot;
}

TEST(Surroundings, hold_every_triangle_in_reach_however_few_nodes_a_tick_visits) {
    Scene scene;
    const CollisionSurface surface(scene.mesh, tilted_tree(scene.mesh, 3), "scene");
    for (const int nodes : {1, 7, 1000000}) {
        Surroundings around;
        around.clear();
        for (int i = 0; i < 200; ++i) {
            const Vector3d p = scene.point();
            around.begin(surface, p, 0.5, 0.01 + 0.02 * i);
            EXPECT_LT(around.room(p, 0.5), 0);
            for (int tick = 0; around.under_way(); ++tick) {
                ASSERT_LT(tick, 100000);
                around.go_on(surface, nodes);
            }
            expect_complete(surface, around, p, 0.5);
        }
    }
}

TEST(Surroundings, shrink_to_what_they_hold) {
    // 32 768 triangles of 0.1 mm, of which 2 mm about a place on the surface hold more than a thousand.
    const TriangleMesh fine = sample::sphere_surface({5, -3, 2}, 5, 6);
    const CollisionSurface surface(fine, sample::median_tree(fine, 4), "fine");
    Surroundings around;
    around.clear();
    for (const Vector3d& p : {Vector3d(10, -3, 2), Vector3d(5, -3, 8), Vector3d(1.4, 0.6, 2)}) {
        around.begin(surface, p, 0, 3);
        around.go_on(surface, 1000000);
        ASSERT_FALSE(around.under_way());
        EXPECT_LT(around.margin(), 3);
        EXPECT_LE(around.count(), Surroundings::capacity);
        EXPECT_GT(around.room(p, 0), 0);
        expect_complete(surface, around, p, 0);
    }
}

TEST(Surroundings, leave_no_room_where_they_cannot_shrink_enough) {
    // A ball that touches thousands of triangles from inside, however small the margin.
    const TriangleMesh fine = sample::sphere_surface({5, -3, 2}, 5, 6);
    const CollisionSurface surface(fine, sample::median_tree(fine, 4), "fine");
    Surroundings around;
    around.clear();
    around.begin(surface, {5, -3, 2}, 5, 1);
    around.go_on(surface, 1000000);
    EXPECT_FALSE(around.under_way());
    EXPECT_LT(around.room({5, -3, 2}, 5), 0);
}

TEST(Surroundings, reach_as_far_as_the_open_does) {
    Scene scene;
    const CollisionSurface surface(scene.mesh, tilted_tree(scene.mesh, 3), "scene");
    const Vector3d far = Scene::middle + Vector3d(200, 0, 0);
    Surroundings around;
    around.clear();
    around.begin(surface, far, 1, 1);
    around.go_on(surface, 1000000);
    EXPECT_EQ(around.count(), 0U);
    EXPECT_GT(around.room(far, 1), 1);
    expect_complete(surface, around, far, 1);
}

TEST(TriangleDisc, holds_its_triangle_and_lies_in_its_plane) {
    constexpr double in_plane = 2e-6;  // relative to the radius, of the plane; float32 of the normal
    Scene scene;
    const CollisionSurface surface(scene.mesh, tilted_tree(scene.mesh, 3), "scene");
    for (std::int32_t slot = 0; slot < surface.triangle_count(); ++slot) {
        const TriangleDisc& disc = surface.disc(slot);
        const Vector3d centre(disc.centre[0], disc.centre[1], disc.centre[2]),
            normal(disc.normal[0], disc.normal[1], disc.normal[2]);
        const auto radius = static_cast<double>(disc.radius);
        for (const Vector3d& corner : surface.corners(slot)) {
            EXPECT_LE((corner - centre).norm(), radius) << slot;
            if (normal.norm() > 0) {
                EXPECT_NEAR(normal.dot(corner - centre), static_cast<double>(disc.lift),
                            in_plane * radius + 1e-9)
                    << slot;
            }
        }
    }
}

}  // namespace
}  // namespace palpate
