// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "runtime/collision/segment_queries.hpp"
#include "tests/runtime/collision/collision_scene.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;

constexpr double segment_tolerance = 1e-9;  // mm: queries compute in double

Vector3d nearest_on_segment(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
    const Vector3d edge = b - a;
    if (edge.isZero(0)) return a;
    return a + std::clamp((p - a).dot(edge) / edge.squaredNorm(), 0.0, 1.0) * edge;
}

Vector3d point_near_origin(std::mt19937& generator) {
    const TriangleCorners t = awkward_triangle(Vector3d::Zero(), generator);
    return t[generator() % 3];
}

// Two points of two convex sets are nearest if and only if each is the point of its set nearest to the other.
TEST(SegmentQueries, points_of_two_segments_are_each_nearest_to_the_other) {
    std::mt19937 generator(1);
    for (int i = 0; i < 10000; ++i) {
        const Vector3d a0 = point_near_origin(generator), b0 = point_near_origin(generator);
        Vector3d a1 = point_near_origin(generator), b1 = point_near_origin(generator);
        if (i % 5 == 1) b1 = b0 + 0.7 * (a1 - a0);                                        // parallel
        if (i % 5 == 2) b1 = b0 - 0.7 * (a1 - a0) + 1e-9 * point_near_origin(generator);  // nearly
        if (i % 50 == 3) a1 = a0;
        if (i % 50 == 4 || i % 50 == 3) b1 = b0;
        const SegmentPair pair = closest_points_of_segments(a0, a1, b0, b1);
        ASSERT_TRUE(pair.s >= 0 && pair.s <= 1 && pair.t >= 0 && pair.t <= 1);
        ASSERT_NEAR((a0 + pair.s * (a1 - a0) - pair.first).norm(), 0, segment_tolerance);
        ASSERT_NEAR((b0 + pair.t * (b1 - b0) - pair.second).norm(), 0, segment_tolerance);
        const double distance = (pair.first - pair.second).norm();
        ASSERT_NEAR(std::sqrt(pair.squared_distance), distance, segment_tolerance);
        ASSERT_NEAR((nearest_on_segment(pair.second, a0, a1) - pair.second).norm(), distance,
                    segment_tolerance)
            << i;
        ASSERT_NEAR((nearest_on_segment(pair.first, b0, b1) - pair.first).norm(), distance, segment_tolerance)
            << i;
    }
}

TEST(SegmentQueries, points_of_segment_and_triangle_are_each_nearest_to_the_other) {
    std::mt19937 generator(2);
    int pierced = 0;
    for (int i = 0; i < 20000; ++i) {
        const TriangleCorners t = awkward_triangle(Vector3d::Zero(), generator);
        Vector3d a = point_near_origin(generator), b = point_near_origin(generator);
        if (i % 7 == 1) b += 20 * ((t[0] + t[1] + t[2]) / 3 - a);  // through the face
        if (i % 7 == 2) b = 2 * t[0] - a;                          // through a corner
        if (i % 7 == 3) b = t[0] + t[1] - a;                       // through an edge
        if (i % 7 == 4) a = t[1];
        if (i % 70 == 5) b = a;
        const SegmentTrianglePair pair = closest_points_of_segment_and_triangle(a, b, t);
        const Vector3d on_triangle = pair.foot.barycentric[0] * t[0] + pair.foot.barycentric[1] * t[1] +
                                     pair.foot.barycentric[2] * t[2];
        const double distance = std::sqrt(pair.foot.squared_distance);
        ASSERT_GE(pair.foot.barycentric.minCoeff(), 0) << i;
        ASSERT_NEAR((on_triangle - pair.foot.point).norm(), 0, segment_tolerance) << i;
        ASSERT_NEAR((a + pair.fraction * (b - a) - pair.segment_point).norm(), 0, segment_tolerance) << i;
        ASSERT_NEAR((pair.segment_point - pair.foot.point).norm(), distance, segment_tolerance) << i;
        ASSERT_NEAR((nearest_on_segment(pair.foot.point, a, b) - pair.foot.point).norm(), distance,
                    segment_tolerance)
            << i;
        ASSERT_NEAR(std::sqrt(closest_point_on_triangle(pair.segment_point, t).squared_distance), distance,
                    segment_tolerance)
            << i;
        pierced += distance < segment_tolerance;
    }
    EXPECT_GT(pierced, 5000);
}

TEST(SegmentQueries, nearest_surface_point_is_that_of_all_triangles) {
    Scene scene;
    const CollisionSurface surface(scene.mesh, tilted_tree(scene.mesh, 3), "scene");
    int found_count = 0, cut_count = 0;
    for (int i = 0; i < 10000; ++i) {
        const TriangleCorners t = surface.corners(i % surface.triangle_count());
        const Vector3d a = scene.awkward_point(t);
        const Vector3d b = i % 3 ? scene.awkward_point(t) : Vector3d(a + 0.02 * (scene.point() - a));
        const double reach = i % 2 ? 1.0 : 2000.0;
        double best = reach * reach;
        bool expected = false;
        for (std::int32_t slot = 0; slot < surface.triangle_count(); ++slot) {
            const double here =
                closest_points_of_segment_and_triangle(a, b, surface.corners(slot)).foot.squared_distance;
            if (here <= best) expected = true;
            best = std::min(best, here);
        }
        const auto found = closest_to_segment(surface, a, b, reach);
        ASSERT_EQ(found.has_value(), expected) << i;
        if (!found) continue;
        ++found_count;
        cut_count += best == 0;
        ASSERT_NEAR(found->foot.distance, std::sqrt(best), segment_tolerance) << i;
        ASSERT_NEAR((found->segment_point - found->foot.point).norm(), found->foot.distance,
                    segment_tolerance)
            << i;
        ASSERT_EQ(found->foot.triangle, surface.mesh_triangle(found->foot.slot));
    }
    EXPECT_GT(found_count, 5000);
    EXPECT_GT(cut_count, 1000);
}

TEST(SegmentQueries, capsule_over_a_plate_touches_below_its_middle) {
    const TriangleMesh plate{{{-10, -10, 0}, {10, -10, 0}, {0, 20, 0}}, {{0, 1, 2}}};
    const CollisionSurface surface(plate, tilted_tree(plate, 3), "plate");
    const auto found = closest_to_segment(surface, {0, 0, 5}, {0, 4, 3}, 3);
    ASSERT_TRUE(found);
    EXPECT_EQ(found->fraction, 1);
    EXPECT_NEAR(found->foot.distance, 3, segment_tolerance);
    EXPECT_NEAR((found->foot.point - Vector3d(0, 4, 0)).norm(), 0, segment_tolerance);
    EXPECT_FALSE(closest_to_segment(surface, {0, 0, 5}, {0, 4, 3}, 2.999));
}

}  // namespace
}  // namespace palpate
