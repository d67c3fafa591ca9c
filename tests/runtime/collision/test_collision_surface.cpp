// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <functional>
#include <gtest/gtest.h>
#include <random>

#include "formats/model/errors.hpp"
#include "runtime/collision/collision_surface.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/runtime/collision/collision_scene.hpp"

namespace palpate {
namespace {

using namespace collision;
using Eigen::Vector3d;

// The tree stores boxes, the surface vertices in float32; queries compute in double on those vertices.
constexpr double surface_tolerance = 1e-9;

TEST(CollisionSurface, closest_point_is_that_of_all_triangles) {
    Scene scene;
    const CollisionSurface surface(scene.mesh, tilted_tree(scene.mesh, 3), "scene");
    std::int32_t hint = -1;
    for (int i = 0; i < 10000; ++i) {
        const Vector3d p = scene.awkward_point(surface.corners(i % surface.triangle_count()));
        const double reach = i % 3 == 0 ? 1.0 : 2000.0;
        double best = reach * reach;
        bool expected = false;
        for (std::int32_t slot = 0; slot < surface.triangle_count(); ++slot) {
            const double here = closest_point_on_triangle(p, surface.corners(slot)).squared_distance;
            if (here <= best) expected = true;
            best = std::min(best, here);
        }
        const auto found = surface.closest_point(p, reach, hint);
        ASSERT_EQ(found.has_value(), expected) << i;
        if (!found) continue;
        ASSERT_NEAR(found->distance, std::sqrt(best), surface_tolerance) << i;
        ASSERT_NEAR((p - found->point).norm(), found->distance, surface_tolerance) << i;
        ASSERT_EQ(found->triangle, surface.mesh_triangle(found->slot));
        hint = found->slot;
    }
}

TEST(CollisionSurface, sweep_stops_at_the_first_of_all_triangles) {
    Scene scene;
    const CollisionSurface surface(scene.mesh, tilted_tree(scene.mesh, 3), "scene");
    std::int32_t hint = -1;
    int touched = 0;
    for (int i = 0; i < 10000; ++i) {
        // Through faces, edges and corners, past them at a tangent, and from far away.
        const TriangleCorners t = surface.corners(i % surface.triangle_count());
        const Vector3d from = scene.awkward_point(t);
        const Vector3d aim = i % 3 ? scene.point() : t[0] + 2 * (scene.awkward_point(t) - t[0]);
        const double length = i % 2 ? 1.0 : 0.05;
        const Vector3d to = from + length * (aim - from);
        const double radius = std::array{0.0, 0.2, 1.0}[static_cast<std::size_t>(i % 3)];
        double first = 2;
        for (std::int32_t slot = 0; slot < surface.triangle_count(); ++slot)
            if (const auto contact = sweep_sphere_triangle(from, to - from, radius, 1, surface.corners(slot)))
                first = std::min(first, contact->fraction);
        const auto found = surface.sweep_sphere(from, to, radius, hint);
        ASSERT_EQ(found.has_value(), first <= 1) << i;
        if (!found) continue;
        ++touched;
        ASSERT_NEAR(found->fraction, first, surface_tolerance) << i;
        hint = found->slot;
    }
    EXPECT_GT(touched, 500);
}

TEST(CollisionSurface, slots_near_miss_no_triangle_in_reach) {
    Scene scene;
    const CollisionSurface surface(scene.mesh, tilted_tree(scene.mesh, 3), "scene");
    std::vector<std::int32_t> slots(static_cast<std::size_t>(surface.triangle_count()));
    for (int i = 0; i < 500; ++i) {
        const Vector3d a = scene.point(), b = a + 0.1 * (scene.point() - a);
        const double radius = 2;
        const std::size_t count = surface.slots_near(a, b, radius, slots);
        ASSERT_LE(count, slots.size());
        const std::vector<std::int32_t> few(slots.begin(),
                                            slots.begin() + static_cast<std::ptrdiff_t>(count));
        for (std::int32_t slot = 0; slot < surface.triangle_count(); ++slot)
            for (const double part : {0.0, 0.3, 0.6, 1.0}) {
                const TrianglePoint here =
                    closest_point_on_triangle(a + part * (b - a), surface.corners(slot));
                ASSERT_TRUE(here.squared_distance >= radius * radius || std::ranges::count(few, slot)) << i;
            }
        std::array<std::int32_t, 2> short_buffer{};
        ASSERT_EQ(surface.slots_near(a, b, radius, short_buffer), count);
    }
}

TEST(CollisionSurface, tells_inside_from_outside_at_faces_edges_and_corners) {
    const TriangleMesh cube = boundary_surface(sample::cube_mesh(2, 20)).surface;
    const CollisionSurface surface(cube, sample::median_tree(cube, 4), "cube");
    std::mt19937 generator(3);
    std::uniform_real_distribution<double> axis(-10, 30);
    for (int i = 0; i < 5000; ++i) {
        const Vector3d p(axis(generator), axis(generator), axis(generator));
        const bool outside = p.minCoeff() < 0 || p.maxCoeff() > 20;
        ASSERT_EQ(surface.is_outside(p), outside) << p.transpose();
    }
}

TEST(CollisionSurface, refuses_a_tree_of_another_surface) {
    const TriangleMesh mesh = sample::sphere_surface({0, 0, 0}, 10, 2);
    const ObbTree good = sample::median_tree(mesh, 4);
    const auto refused = [&](const std::function<void(TriangleMesh&, ObbTree&)>& spoil) {
        TriangleMesh bad_mesh = mesh;
        ObbTree bad_tree = good;
        spoil(bad_mesh, bad_tree);
        EXPECT_THROW(CollisionSurface(bad_mesh, bad_tree, "liver"), InvalidInput);
    };
    EXPECT_NO_THROW(CollisionSurface(mesh, good, "liver"));
    refused([](TriangleMesh& m, ObbTree&) { m.triangles.clear(); });
    refused([](TriangleMesh& m, ObbTree&) { m.triangles.pop_back(); });
    refused([](TriangleMesh& m, ObbTree&) { m.triangles.back()[1] = 1000000; });
    refused([](TriangleMesh& m, ObbTree&) { m.triangles.back()[1] = -1; });
    refused([](TriangleMesh&, ObbTree& t) { t.triangle_order[5] = t.triangle_order[6]; });
    refused([](TriangleMesh&, ObbTree& t) { t.triangle_order[5] = -1; });
    refused([](TriangleMesh&, ObbTree& t) { t.nodes.clear(); });
    refused([](TriangleMesh&, ObbTree& t) { t.nodes.pop_back(); });
    refused([](TriangleMesh&, ObbTree& t) { t.nodes[0].first = 0; });
    refused([](TriangleMesh&, ObbTree& t) { t.nodes[1].first = t.nodes[0].first; });
    refused([](TriangleMesh&, ObbTree& t) { t.nodes.back().first = 1000; });
    refused([](TriangleMesh&, ObbTree& t) { t.nodes.back().count = -1; });
    refused([](TriangleMesh&, ObbTree& t) { t.nodes.back().count -= 1; });
}

TEST(CollisionSurface, refuses_a_tree_deeper_than_its_stack) {
    const TriangleMesh mesh = sample::sphere_surface({0, 0, 0}, 10, 3);
    ObbTree chain = sample::median_tree(mesh, mesh.triangles.size());
    const ObbNode root = chain.nodes.front();
    const auto last = static_cast<std::int32_t>(mesh.triangles.size()) - 1;
    for (std::int32_t i = 0; i < last; ++i) {
        // Node 2 i holds the triangles from i on: one to the left, the others to the right.
        ObbNode left = root, right = root;
        left.first = i;
        left.count = 1;
        right.first = i + 1;
        right.count = last - i;
        chain.nodes.back().first = static_cast<std::int32_t>(chain.nodes.size());
        chain.nodes.back().count = 0;
        chain.nodes.push_back(left);
        chain.nodes.push_back(right);
    }
    EXPECT_THROW(CollisionSurface(mesh, chain, "liver"), InvalidInput);
}

}  // namespace
}  // namespace palpate
