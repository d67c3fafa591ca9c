// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <cmath>
#include <gtest/gtest.h>
#include <random>

#include "runtime/collision/triangle_queries.hpp"
#include "tests/runtime/collision/collision_scene.hpp"

namespace palpate {
namespace {

using namespace collision;
using Eigen::Vector3d;

constexpr double triangle_tolerance = 1e-9;  // mm: coordinates of a few mm, squared, in double

class RandomTriangles {
  public:
    Vector3d point(double reach) { return in_cube(reach, generator_); }
    // Every third triangle is a needle, a doubled corner or a single point.
    TriangleCorners triangle(int index) {
        TriangleCorners t{point(2), point(2), point(2)};
        if (index % 12 == 0) t[2] = 0.5 * (t[0] + t[1]);
        if (index % 12 == 3) t[1] = t[0];
        if (index % 12 == 6) t[1] = t[2] = t[0];
        if (index % 12 == 9) t[2] = t[0] + 1e-7 * (t[2] - t[0]);
        return t;
    }

  private:
    std::mt19937 generator_{7};
};

double distance(const Vector3d& p, const TriangleCorners& t) {
    return std::sqrt(closest_point_on_triangle(p, t).squared_distance);
}

TEST(ClosestPointOnTriangle, satisfies_the_variational_inequality) {
    // q is the nearest point of a convex set exactly if (p - q) . (v - q) <= 0 for all of it, hence for its
    // corners.
    RandomTriangles random;
    for (int i = 0; i < 10000; ++i) {
        const TriangleCorners t = random.triangle(i);
        const Vector3d p = random.point(3);
        const TrianglePoint q = closest_point_on_triangle(p, t);
        for (const Vector3d& corner : t)
            ASSERT_LE((p - q.point).dot(corner - q.point), triangle_tolerance) << i;
        ASSERT_GE(q.barycentric.minCoeff(), 0);
        ASSERT_NEAR(q.barycentric.sum(), 1, 1e-12);
        const Vector3d sum = q.barycentric[0] * t[0] + q.barycentric[1] * t[1] + q.barycentric[2] * t[2];
        ASSERT_LE((sum - q.point).norm(), triangle_tolerance);
        ASSERT_NEAR(q.squared_distance, (p - q.point).squaredNorm(), triangle_tolerance);
    }
}

TEST(ClosestPointOnTriangle, names_the_feature) {
    const TriangleCorners t{Vector3d(0, 0, 0), Vector3d(2, 0, 0), Vector3d(0, 2, 0)};
    EXPECT_EQ(closest_point_on_triangle({0.5, 0.5, 1}, t).feature, Feature::face);
    EXPECT_EQ(closest_point_on_triangle({1, -1, 1}, t).feature, Feature::edge);
    EXPECT_EQ(closest_point_on_triangle({2, 2, 0}, t).feature, Feature::edge);
    EXPECT_EQ(closest_point_on_triangle({-1, 1, 0}, t).feature, Feature::edge);
    EXPECT_EQ(closest_point_on_triangle({-1, -1, 0}, t).feature, Feature::vertex);
    EXPECT_EQ(closest_point_on_triangle({5, -1, 0}, t).feature, Feature::vertex);
    EXPECT_EQ(closest_point_on_triangle({-1, 5, 0}, t).feature, Feature::vertex);
}

TEST(SweepSphereTriangle, stops_at_the_first_time_the_distance_is_the_radius) {
    RandomTriangles random;
    int touched = 0;
    for (int i = 0; i < 10000; ++i) {
        const TriangleCorners t = random.triangle(i);
        const Vector3d from = random.point(3), way = random.point(4);
        const double radius = i % 5 == 0 ? 0.01 : 0.5;
        const auto contact = sweep_sphere_triangle(from, way, radius, 1, t);
        const double end = contact ? contact->fraction : 1;
        if (distance(from, t) <= radius) {
            // Overlapping at the start: a touch at once, or never nearer again.
            if (contact)
                ASSERT_EQ(contact->fraction, 0);
            else
                for (int s = 1; s <= 20; ++s)
                    ASSERT_GE(distance(from + way * s / 20, t), distance(from, t) - triangle_tolerance) << i;
            continue;
        }
        for (int s = 0; s < 20; ++s)
            ASSERT_GE(distance(from + end * s / 20 * way, t), radius - triangle_tolerance) << i;
        if (!contact) continue;
        ++touched;
        const Vector3d centre = from + end * way;
        ASSERT_NEAR(distance(centre, t), radius, 1e-7) << i;
        ASSERT_NEAR((centre - contact->point).norm(), radius, 1e-7) << i;
        ASSERT_NEAR(contact->normal.norm(), 1, 1e-9);
        ASSERT_LE(contact->normal.dot(way), triangle_tolerance) << i;
    }
    EXPECT_GT(touched, 300);
}

TEST(SweepSphereTriangle, a_point_hits_the_face_between_two_triangles) {
    // Radius 0 through the shared edge: one of the two must stop it.
    const Vector3d a(0, 0, 0), b(1, 0.3, 0.1), c(0.2, 1, 0), d(0.7, -1, 0.2);
    for (int i = 1; i < 100; ++i) {
        const Vector3d on_edge = a + i / 100.0 * (b - a);
        const Vector3d from = on_edge + Vector3d(0.1, 0.05, 1), way = 2 * (on_edge - from);
        EXPECT_TRUE(sweep_sphere_triangle(from, way, 0, 1, {a, b, c}) ||
                    sweep_sphere_triangle(from, way, 0, 1, {a, d, b}))
            << i;
    }
}

TEST(SweepSphereTriangle, stops_over_face_edge_and_corner_where_calculated_by_hand) {
    const TriangleCorners t{Vector3d(0, 0, 0), Vector3d(4, 0, 0), Vector3d(0, 4, 0)};
    const auto face = sweep_sphere_triangle({1, 1, 3}, {0, 0, -4}, 1, 1, t);
    ASSERT_TRUE(face);
    EXPECT_NEAR(face->fraction, 0.5, 1e-12);
    EXPECT_NEAR((face->normal - Vector3d::UnitZ()).norm(), 0, 1e-12);
    // 0.6 beside the edge, radius 1: the centre stops 0.8 above it.
    const auto edge = sweep_sphere_triangle({2, -0.6, 2.8}, {0, 0, -4}, 1, 1, t);
    ASSERT_TRUE(edge);
    EXPECT_NEAR(edge->fraction, 0.5, 1e-12);
    EXPECT_NEAR((edge->normal - Vector3d(0, -0.6, 0.8)).norm(), 0, 1e-12);
    const auto corner = sweep_sphere_triangle({-3, 0, 0}, {4, 0, 0}, 1, 1, t);
    ASSERT_TRUE(corner);
    EXPECT_NEAR(corner->fraction, 0.5, 1e-12);
    EXPECT_NEAR((corner->point - Vector3d::Zero()).norm(), 0, 1e-12);
    EXPECT_FALSE(sweep_sphere_triangle({1, 1, 3}, {0, 0, -1.5}, 1, 1, t));
    EXPECT_FALSE(sweep_sphere_triangle({-1, -1, 3}, {0, 0, -4}, 1, 1, t));
}

}  // namespace
}  // namespace palpate
