// SPDX-License-Identifier: Apache-2.0
// Which feature of a surface is nearest to what is outside, and surfaces with short edges.
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <bit>
#include <gtest/gtest.h>
#include <map>
#include <numbers>
#include <random>

#include "runtime/collision/features/split_edges.hpp"
#include "runtime/collision/features/surface_features.hpp"
#include "tests/runtime/collision/collision_scene.hpp"

namespace palpate {
namespace {

using namespace collision;
using Eigen::Vector3d;

// A cube of edge 2 about the origin, two triangles a side, one of its corners as far out as `corner`.
TriangleMesh cube(double corner = 1) {
    TriangleMesh mesh;
    for (int i = 0; i < 8; ++i) mesh.vertices.emplace_back(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    mesh.vertices[7] *= corner;
    mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return mesh;
}

SurfaceFeatures features_of(const TriangleMesh& mesh) {
    return {mesh.vertices, mesh.triangles};
}

int owned(const SurfaceFeatures& features, std::uint8_t TriangleFeatures::*bits) {
    int count = 0;
    for (std::size_t t = 0; t < features.triangle_count(); ++t) count += std::popcount(features.of(t).*bits);
    return count;
}

TEST(SurfaceFeatures, each_vertex_and_each_edge_belongs_to_one_triangle) {
    const SurfaceFeatures features = features_of(cube());
    EXPECT_EQ(owned(features, &TriangleFeatures::own_vertices), 8);
    EXPECT_EQ(owned(features, &TriangleFeatures::own_edges), 18);
    EXPECT_EQ(owned(features, &TriangleFeatures::own_sharp_edges), 12);  // and no diagonal
    // A corner pushed in to the middle: its three edges are concave, the three diagonals across it convex.
    const SurfaceFeatures dented = features_of(cube(0));
    EXPECT_EQ(owned(dented, &TriangleFeatures::own_sharp_edges), 9 + 3);
    for (std::size_t t = 0; t < dented.triangle_count(); ++t)
        for (std::size_t i = 0; i < 3; ++i) {
            const auto& v = dented.of(t).vertices;
            if (v[i] == 7 || v[(i + 1) % 3] == 7) {
                EXPECT_EQ(dented.of(t).own_sharp_edges >> i & 1, 0) << t << ' ' << i;
            }
        }
}

TEST(SurfaceFeatures, an_edge_of_one_triangle_or_of_three_is_a_border) {
    TriangleMesh mesh;
    mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}};
    mesh.triangles = {{0, 1, 2}, {1, 0, 3}, {0, 1, 4}};
    const SurfaceFeatures features = features_of(mesh);
    for (std::size_t t = 0; t < 3; ++t) {
        EXPECT_EQ(features.of(t).own_sharp_edges, 7);
        EXPECT_EQ(features.of(t).across, (std::array<std::int32_t, 3>{-1, -1, -1}));
    }
}

// By the definition: of the triangles that hold the point none has a nearer one.
TEST(SurfaceFeatures, what_is_nearest_is_so_by_every_triangle_about_it) {
    const TriangleMesh mesh = spiky_ball(4);
    const SurfaceFeatures features = features_of(mesh);
    std::mt19937 random(2);
    std::array<std::array<int, 2>, 3> seen{};  // by feature and answer
    for (int n = 0; n < 20'000; ++n) {
        const auto t = std::uniform_int_distribution<std::size_t>(0, mesh.triangles.size() - 1)(random);
        const TriangleCorners corners = features.corners(t);
        // From near a corner or an edge.
        const Vector3d p = corners[0] + 0.3 * (n % 2) * (corners[1] - corners[0]) + in_cube(1e-3, random);
        const TrianglePoint found = closest_point_on_triangle(p, corners);
        double nearest = std::numeric_limits<double>::infinity();
        for (std::size_t other = 0; other < mesh.triangles.size(); ++other) {
            constexpr double rounding = 1e-20;  // mm²
            const TriangleCorners its = features.corners(other);
            if (closest_point_on_triangle(found.point, its).squared_distance > rounding) continue;
            nearest = std::min(nearest, closest_point_on_triangle(p, its).squared_distance);
        }
        const bool is_nearest = !(nearest < found.squared_distance * (1 - 1e-9));
        EXPECT_EQ(features.is_nearest(t, found, p - found.point), is_nearest) << n;
        ++seen[static_cast<std::size_t>(found.feature)][is_nearest];
    }
    for (const Feature feature : {Feature::edge, Feature::vertex})
        for (const int count : seen[static_cast<std::size_t>(feature)]) EXPECT_GT(count, 20);
}

TEST(SplitEdges, no_edge_stays_long_and_the_surface_is_the_same_and_closed) {
    const TriangleMesh mesh = spiky_ball(4);
    const double longest = 0.7;
    const TriangleMesh split = split_long_edges(mesh, longest, 1'000'000);
    EXPECT_GT(split.triangles.size(), mesh.triangles.size());
    const auto area = [](const TriangleMesh& m) {
        Vector3d sums = Vector3d::Zero();  // of areas and of twice two moments
        for (const Triangle& t : m.triangles) {
            const TriangleCorners c = corners_of(m, t);
            const Vector3d cross = (c[1] - c[0]).cross(c[2] - c[0]);
            sums += Vector3d(cross.norm(), cross.dot(c[0]), (c[0] + c[1] + c[2]).x() * cross.norm());
        }
        return sums;
    };
    EXPECT_LT((area(split) - area(mesh)).norm(), 1e-9 * area(mesh).norm());
    std::map<std::pair<std::int32_t, std::int32_t>, int> ways;
    for (const Triangle& t : split.triangles)
        for (std::size_t i = 0; i < 3; ++i) {
            ++ways[{t[i], t[(i + 1) % 3]}];
            const Vector3d edge = split.vertices[t[i]] - split.vertices[t[(i + 1) % 3]];
            EXPECT_LE(edge.norm(), longest * (1 + 1e-12));
        }
    for (const auto& [way, count] : ways) {
        EXPECT_EQ(count, 1);
        EXPECT_TRUE(ways.contains({way.second, way.first}));
    }
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) EXPECT_EQ(split.vertices[v], mesh.vertices[v]);
}

TEST(SplitEdges, stops_before_there_are_too_many) {
    const TriangleMesh mesh = cube();
    EXPECT_EQ(split_long_edges(mesh, 0.01, 100).triangles.size(), 48);
    EXPECT_EQ(split_long_edges(mesh, 5, 100).triangles.size(), 12);
}

}  // namespace
}  // namespace palpate
