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

using namespace collision;
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

TEST(SegmentQueries, a_segment_pierces_where_it_crosses_the_inside_of_a_triangle) {
    std::mt19937 generator(2);
    std::uniform_real_distribution<double> uniform(0.1, 1);
    for (int i = 0; i < 10000; ++i) {
        TriangleCorners t;
        for (Vector3d& corner : t) corner = 10 * Vector3d::NullaryExpr([&] { return uniform(generator); });
        const Vector3d normal = (t[1] - t[0]).cross(t[2] - t[0]);
        if (normal.norm() < 1) continue;
        Vector3d weights = Vector3d::NullaryExpr([&] { return uniform(generator); });
        weights /= weights.sum();
        const auto at = [&](const Vector3d& w) -> Vector3d {
            return w[0] * t[0] + w[1] * t[1] + w[2] * t[2];
        };
        const Vector3d sideways = uniform(generator) * (t[1] - t[0]), over = normal.normalized() + sideways;
        const auto through = pierce(at(weights) - over, at(weights) + 3 * over, t);
        ASSERT_TRUE(through) << i;
        ASSERT_NEAR(through->fraction, 0.25, segment_tolerance) << i;
        ASSERT_NEAR((through->segment_point - at(weights)).norm(), 0, segment_tolerance) << i;
        ASSERT_NEAR((through->foot.barycentric - weights).norm(), 0, segment_tolerance) << i;
        ASSERT_EQ(through->foot.squared_distance, 0) << i;
        EXPECT_FALSE(pierce(at(weights) + 1e-6 * over, at(weights) + over, t)) << i;  // ends before it
        const Vector3d outside = at({-0.01, 0.5, 0.51});
        EXPECT_FALSE(pierce(outside - over, outside + over, t)) << i;
    }
}

}  // namespace
}  // namespace palpate
