// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <set>
#include <vector>

#include "runtime/collision/tree_pairs.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/runtime/collision/collision_scene.hpp"
#include "tests/runtime/samples.hpp"

namespace palpate {
namespace {

using namespace collision;
using Eigen::Vector3d;

constexpr double pair_tolerance = 1e-9;  // mm: queries compute in double

Vector3d at(const Vector3d& barycentric, const TriangleCorners& t) {
    return barycentric[0] * t[0] + barycentric[1] * t[1] + barycentric[2] * t[2];
}

// Two points of two convex sets are nearest if and only if each is the point of its set nearest to the other.
TEST(TreePairs, points_of_two_triangles_are_each_nearest_to_the_other) {
    std::mt19937 generator(1);
    int cut = 0;
    for (int i = 0; i < 20000; ++i) {
        TriangleCorners a = awkward_triangle(Vector3d::Zero(), generator);
        TriangleCorners b = awkward_triangle(Vector3d(0, 0, i % 4), generator);
        if (i % 9 == 1) b[1] = a[2];
        if (i % 9 == 2) b = {a[2], a[1], b[0]};
        if (i % 9 == 3) b = a;
        if (i % 9 == 4)
            for (std::size_t c = 0; c < 3; ++c) a[c].z() = b[c].z() = 0;
        const TrianglePair pair = closest_points_of_triangles(a, b);
        const Vector3d &on_a = pair.on_a.point, &on_b = pair.on_b.point;
        const double distance = std::sqrt(pair.on_a.squared_distance);
        ASSERT_EQ(pair.on_a.squared_distance, pair.on_b.squared_distance);
        ASSERT_TRUE(pair.on_a.barycentric.minCoeff() >= 0 && pair.on_b.barycentric.minCoeff() >= 0) << i;
        ASSERT_NEAR((at(pair.on_a.barycentric, a) - on_a).norm(), 0, pair_tolerance) << i;
        ASSERT_NEAR((at(pair.on_b.barycentric, b) - on_b).norm(), 0, pair_tolerance) << i;
        ASSERT_NEAR((on_b - on_a).norm(), distance, pair_tolerance) << i;
        ASSERT_NEAR(std::sqrt(closest_point_on_triangle(on_b, a).squared_distance), distance, pair_tolerance)
            << i;
        ASSERT_NEAR(std::sqrt(closest_point_on_triangle(on_a, b).squared_distance), distance, pair_tolerance)
            << i;
        if (distance > pair_tolerance) {
            ASSERT_NEAR((on_a + distance * pair.normal - on_b).norm(), 0, pair_tolerance) << i;
        }
        cut += distance <= pair_tolerance;
    }
    EXPECT_GT(cut, 5000);
}

TEST(TreePairs, normal_of_a_cut_leads_out_of_a) {
    const TriangleCorners plate{Vector3d(-5, -5, 0), Vector3d(5, -5, 0), Vector3d(0, 8, 0)};
    const TriangleCorners spike{Vector3d(0, 0, -1), Vector3d(-1, 0, 4), Vector3d(1, 0, 4)};
    const TrianglePair pierced = closest_points_of_triangles(plate, spike);
    EXPECT_EQ(pierced.on_a.squared_distance, 0);
    EXPECT_NEAR((pierced.normal - Vector3d::UnitZ()).norm(), 0, pair_tolerance);
    EXPECT_NEAR((closest_points_of_triangles(spike, plate).normal + Vector3d::UnitZ()).norm(), 0,
                pair_tolerance);
}

// Everything about pairs, by looking at all of them.
TEST(TreePairs, pairs_are_those_of_all_triangles) {
    Scene scene_a(0, 6), scene_b(0, 3);
    for (Vector3d& vertex : scene_b.mesh.vertices) vertex -= Scene::middle;
    const CollisionSurface a(scene_a.mesh, tilted_tree(scene_a.mesh, 2), "a");
    const CollisionSurface b(scene_b.mesh, tilted_tree(scene_b.mesh, 2), "b");
    const auto all = static_cast<std::size_t>(a.triangle_count() * b.triangle_count());
    std::vector<SurfacePair> pairs(all);
    std::mt19937 generator(3);
    std::normal_distribution<double> axis;
    int touching = 0, apart = 0;
    for (int i = 0; i < samples_of(10000); ++i) {
        Eigen::Isometry3d X_AB = Eigen::Isometry3d::Identity();
        X_AB.translation() =
            Scene::middle + (i % 3 ? 15 : 4) * Vector3d(axis(generator), axis(generator), axis(generator));
        if (i % 10 == 0) X_AB.translation() = Scene::middle + Vector3d(24, 0, 0);  // corner to corner
        if (i % 10 >= 2)  // else the boxes' axes are parallel
            X_AB.linear() =
                Eigen::Quaterniond(axis(generator), axis(generator), axis(generator), axis(generator))
                    .normalized()
                    .toRotationMatrix();
        const double margin = i % 4 == 0 ? 0 : i % 4 == 1 ? 0.5 : i % 4 == 2 ? 5 : 1e-6;
        const std::size_t count = pairs_near(a, b, X_AB, margin, pairs);
        ASSERT_LE(count, all);
        std::set<std::pair<std::int32_t, std::int32_t>> found;
        for (std::size_t k = 0; k < count; ++k) found.emplace(pairs[k].slot_a, pairs[k].slot_b);
        ASSERT_EQ(found.size(), count);
        for (std::int32_t slot_b = 0; slot_b < b.triangle_count(); ++slot_b) {
            TriangleCorners corners_b = b.corners(slot_b);
            for (Vector3d& corner : corners_b) corner = X_AB * corner;
            for (std::int32_t slot_a = 0; slot_a < a.triangle_count(); ++slot_a) {
                const double distance = std::sqrt(
                    closest_points_of_triangles(a.corners(slot_a), corners_b).on_a.squared_distance);
                // At the limit itself rounding decides.
                if (std::abs(distance - margin) > 2 * pair_tolerance) {
                    ASSERT_EQ(found.contains({slot_a, slot_b}), distance < margin)
                        << i << ": " << distance << " mm, margin " << margin;
                }
            }
        }
        for (std::size_t k = 0; k < count; ++k) {
            const SurfacePair& pair = pairs[k];
            ASSERT_EQ(pair.triangle_a, a.mesh_triangle(pair.slot_a));
            ASSERT_EQ(pair.triangle_b, b.mesh_triangle(pair.slot_b));
            const Vector3d in_a = at(pair.contact.on_a.barycentric, a.corners(pair.slot_a));
            const Vector3d in_b = X_AB * at(pair.contact.on_b.barycentric, b.corners(pair.slot_b));
            ASSERT_NEAR((in_a - in_b).norm(), std::sqrt(pair.contact.on_a.squared_distance), pair_tolerance);
        }
        ASSERT_EQ(surfaces_touch(a, b, X_AB, margin), count > 0);
        ++(count > 0 ? touching : apart);
    }
    EXPECT_GT(touching, samples_of(1000));
    EXPECT_GT(apart, samples_of(1000));
}

TEST(TreePairs, more_pairs_than_fit_are_counted) {
    const TriangleMesh sphere = sample::sphere_surface({0, 0, 0}, 10, 2);
    const CollisionSurface surface(sphere, tilted_tree(sphere, 3), "sphere");
    const Eigen::Isometry3d X_AB(Eigen::Translation3d(15, 0, 0));
    std::vector<SurfacePair> pairs(10000);
    const std::size_t count = pairs_near(surface, surface, X_AB, 0.5, pairs);
    ASSERT_GT(count, 3U);
    std::array<SurfacePair, 3> few;
    EXPECT_EQ(pairs_near(surface, surface, X_AB, 0.5, few), count);
    for (std::size_t k = 0; k < few.size(); ++k) EXPECT_EQ(few[k].slot_a, pairs[k].slot_a);
    EXPECT_EQ(pairs_near(surface, surface, X_AB, 0.5, {}), count);
}

}  // namespace
}  // namespace palpate
