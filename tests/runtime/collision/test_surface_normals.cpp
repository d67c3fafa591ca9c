// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

#include "formats/model/closure.hpp"
#include "runtime/collision/collision_surface.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/runtime/collision/collision_scene.hpp"

namespace palpate {
namespace {

using namespace collision;
using Eigen::Vector3d;

constexpr double normal_tolerance = 1e-9;  // mm, and radians: queries compute in double

CollisionSurface surface_of(const TriangleMesh& mesh) {
    return {mesh, sample::median_tree(mesh, 4), "surface"};
}

// A closed cone over a regular polygon, its tip up; with few sides a spike.
TriangleMesh cone(int sides, double radius, double height) {
    TriangleMesh mesh;
    mesh.vertices = {{0, 0, height}, {0, 0, 0}};
    for (int i = 0; i < sides; ++i) {
        const double angle = 2 * std::numbers::pi * i / sides;
        mesh.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0);
    }
    for (int i = 0; i < sides; ++i) {
        const std::int32_t here = 2 + i, next = 2 + (i + 1) % sides;
        mesh.triangles.push_back({0, here, next});
        mesh.triangles.push_back({1, next, here});
    }
    return mesh;
}

TEST(SurfaceNormals, inside_is_where_the_surface_winds_about_the_point) {
    int inside = 0, at_corners = 0;
    for (unsigned seed = 1; seed <= 10; ++seed) {
        const TriangleMesh mesh = spiky_ball(seed);
        const CollisionSurface surface = surface_of(mesh);
        std::mt19937 generator(seed);
        std::normal_distribution<double> axis;
        std::uniform_real_distribution<double> exponent(-4, 1);
        for (int i = 0; i < 1000; ++i) {
            // Everywhere, and close to corners and edges.
            const Vector3d any(axis(generator), axis(generator), axis(generator));
            const TriangleCorners t = surface.corners(
                static_cast<std::int32_t>(generator() % static_cast<unsigned>(surface.triangle_count())));
            const Vector3d way = i % 2 ? any : Vector3d(any + 2 * t[0].normalized());
            const Vector3d offset = std::pow(10, exponent(generator)) * way;
            const Vector3d near = i % 4 ? t[0] : Vector3d(0.3 * t[0] + 0.7 * t[1]);
            const Vector3d p = i % 8 == 7 ? Vector3d(8 * any) : Vector3d(near + offset);
            const double winding = winding_number(mesh, p);
            ASSERT_NEAR(winding, std::round(winding), 1e-6);
            ASSERT_EQ(surface.is_outside(p), std::round(winding) == 0) << p.transpose();
            ASSERT_EQ(surface.inside_or_outside(p), std::round(winding) == 0 ? 1 : -1);
            inside += std::round(winding) == 1;
            at_corners += surface.closest_point(p, 1e3)->feature == Feature::vertex;
        }
    }
    EXPECT_GT(inside, 2000);
    EXPECT_GT(at_corners, 1000);
}

TEST(SurfaceNormals, beyond_a_leaning_spike_is_outside) {
    // The face most square to p turns away from it: n.p is -0.71 for that face, 0.36 for the other two.
    const TriangleMesh spike{{{0, 0, 0}, {0, 1, -1}, {0.1, 1, -1}, {1, 3.4, -1}},
                             {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}}};
    const Vector3d p(0, 0, 0.5);
    ASSERT_NEAR(winding_number(spike, p), 0, normal_tolerance);
    ASSERT_NEAR(winding_number(spike, Vector3d(0.3, 1.6, -0.95)), 1, normal_tolerance);
    EXPECT_TRUE(surface_of(spike).is_outside(p));
    EXPECT_FALSE(surface_of(spike).is_outside({0.3, 1.6, -0.95}));
}

TEST(SurfaceNormals, a_corner_may_join_any_number_of_triangles) {
    const CollisionSurface tip = surface_of(cone(500, 3, 8));
    EXPECT_NEAR((tip.pseudonormal({0, 0, 8}) - Vector3d::UnitZ()).norm(), 0, 1e-6);  // float32 vertices
    EXPECT_TRUE(tip.is_outside({0, 0, 9}));
    EXPECT_FALSE(tip.is_outside({0, 0, 7}));
    EXPECT_TRUE(tip.is_outside({0, 0, -1}));
}

TEST(SurfaceNormals, a_point_on_the_surface_is_not_outside) {
    const CollisionSurface surface = surface_of(cone(4, 3, 8));
    EXPECT_FALSE(surface.is_outside({0, 0, 8}));
    EXPECT_FALSE(surface.is_outside({0, 0, 0}));
    EXPECT_EQ(surface.inside_or_outside({0, 0, 0}), -1);
}

TEST(SurfaceNormals, corner_of_a_cube_looks_along_its_diagonal_however_the_faces_are_cut) {
    const TriangleMesh cube = boundary_surface(sample::cube_mesh(2, 20)).surface;
    const CollisionSurface surface = surface_of(cube);
    for (const double x : {0.0, 20.0})
        for (const double y : {0.0, 20.0})
            for (const double z : {0.0, 20.0}) {
                const Vector3d corner(x, y, z);
                const Vector3d diagonal = (corner - Vector3d(10, 10, 10)).normalized();
                EXPECT_NEAR((surface.pseudonormal(corner) - diagonal).norm(), 0, normal_tolerance);
            }
    EXPECT_NEAR((surface.pseudonormal({20, 20, 7}) - Vector3d(1, 1, 0).normalized()).norm(), 0,
                normal_tolerance);
    EXPECT_NEAR((surface.pseudonormal({20, 6, 7}) - Vector3d::UnitX()).norm(), 0, normal_tolerance);
    EXPECT_EQ(surface.pseudonormal({10, 10, 10}), Vector3d::Zero());
}

TEST(SurfaceNormals, triangles_without_area_change_no_sign) {
    // One base edge carries a vertex that only a triangle without area joins to the base.
    TriangleMesh mesh{{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 4}, {2, 0, 0}},
                      {{0, 2, 1}, {0, 4, 3}, {4, 1, 3}, {1, 2, 3}, {0, 3, 2}, {0, 1, 4}}};
    const CollisionSurface surface = surface_of(mesh);
    EXPECT_NEAR((surface.pseudonormal({2, 0, 0}) - Vector3d(0, -1, -1).normalized()).norm(), 0,
                normal_tolerance);
    for (const Vector3d& way : {Vector3d(0, -1, -1), Vector3d(0, -1, -0.1), Vector3d(0, -0.1, -1)}) {
        EXPECT_TRUE(surface.is_outside(Vector3d(2, 0, 0) + 0.5 * way));
        EXPECT_FALSE(surface.is_outside(Vector3d(2, 0, 0) - 0.1 * way));
    }
    const auto slot_of = [&](std::int32_t triangle) {
        std::int32_t slot = 0;
        while (surface.mesh_triangle(slot) != triangle) ++slot;
        return slot;
    };
    ClosestPoint found;
    found.point = {2, 0, 0};
    found.slot = slot_of(5);
    EXPECT_NEAR((surface.outward_normal(found) - Vector3d(0, -1, -1).normalized()).norm(), 0,
                normal_tolerance);
    found.slot = slot_of(0);
    EXPECT_NEAR((surface.outward_normal(found) - Vector3d(0, 0, -1)).norm(), 0, normal_tolerance);
}

TEST(SurfaceNormals, outward_normal_is_that_of_the_triangle_found) {
    const TriangleMesh mesh = spiky_ball(7);
    const CollisionSurface surface = surface_of(mesh);
    std::mt19937 generator(5);
    std::normal_distribution<double> axis(0, 8);
    for (int i = 0; i < 1000; ++i) {
        const Vector3d p(axis(generator), axis(generator), axis(generator));
        const auto found = surface.closest_point(p, 1e3);
        ASSERT_TRUE(found);
        const Vector3d normal = surface.outward_normal(*found);
        ASSERT_NEAR(normal.norm(), 1, normal_tolerance);
        const TriangleCorners t = surface.corners(found->slot);
        for (const Vector3d& corner : t) ASSERT_NEAR(normal.dot(corner - t[0]), 0, 1e-6);
        if (found->feature == Feature::face) {
            ASSERT_EQ(normal.dot(p - found->point) > 0, surface.is_outside(p));
        }
    }
}

}  // namespace
}  // namespace palpate
