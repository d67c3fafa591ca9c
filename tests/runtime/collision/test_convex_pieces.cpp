// SPDX-License-Identifier: Apache-2.0
// Surfaces cut into convex pieces, and the closest features of two pieces against all pairs of triangles.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <random>
#include <set>
#include <vector>

#include "formats/model/errors.hpp"
#include "runtime/collision/balls/ball_pairs.hpp"
#include "runtime/collision/convex/closest_features.hpp"
#include "runtime/collision/convex/convex_pieces.hpp"
#include "runtime/collision/convex/equally_near_vertices.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/runtime/collision/bumpy_ball.hpp"
#include "tests/runtime/samples.hpp"

namespace palpate {
namespace {

using namespace collision;
using Eigen::Isometry3d;
using Eigen::Vector3d;

// A box from `low` to `high`, two triangles a side.
TriangleMesh box(const Vector3d& low, const Vector3d& high) {
    TriangleMesh mesh;
    for (int i = 0; i < 8; ++i)
        mesh.vertices.emplace_back((i & 1 ? high : low).x(), (i & 2 ? high : low).y(),
                                   (i & 4 ? high : low).z());
    mesh.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                      {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    return mesh;
}

// A ring about z whose outer half is one convex surface with a hole in the middle.
TriangleMesh ring(double radius, double thickness, int around, int across) {
    TriangleMesh mesh;
    for (int i = 0; i < around; ++i)
        for (int j = 0; j < across; ++j) {
            const double u = 2 * std::numbers::pi * i / around, v = 2 * std::numbers::pi * j / across;
            const double out = radius + thickness * std::cos(v);
            mesh.vertices.emplace_back(out * std::cos(u), out * std::sin(u), thickness * std::sin(v));
            const auto at = [&](int a, int b) { return (i + a) % around * across + (j + b) % across; };
            mesh.triangles.push_back({at(0, 0), at(1, 0), at(1, 1)});
            mesh.triangles.push_back({at(0, 0), at(1, 1), at(0, 1)});
        }
    return mesh;
}

struct Surface {
    explicit Surface(const TriangleMesh& mesh) : features(mesh.vertices, mesh.triangles), pieces(features) {}
    SurfaceFeatures features;
    ConvexPieces pieces;
};

double apart(const Surface& a, const Isometry3d& X_BA, const Surface& b, const PiecePair& pair) {
    double least = std::numeric_limits<double>::infinity();
    for (const std::int32_t of_a : a.pieces.piece(pair.piece_a).triangles) {
        const TriangleCorners corners = placed(X_BA, a.features.corners(static_cast<std::size_t>(of_a)));
        for (const std::int32_t of_b : b.pieces.piece(pair.piece_b).triangles)
            least = std::min(least, closest_points_of_triangles(
                                        corners, b.features.corners(static_cast<std::size_t>(of_b)))
                                        .on_a.squared_distance);
    }
    return std::sqrt(least);
}

TEST(ConvexPieces, hold_every_triangle_once_and_none_before_anothers_plane) {
    for (const TriangleMesh& mesh : {bumpy_ball(10, 3, 0.15), ring(10, 3, 24, 12)}) {
        const Surface surface(mesh);
        std::set<std::int32_t> seen;
        for (std::int32_t p = 0; p < static_cast<std::int32_t>(surface.pieces.count()); ++p) {
            const ConvexPiece piece = surface.pieces.piece(p);
            std::set<std::int32_t> vertices;
            for (const std::int32_t t : piece.triangles) {
                EXPECT_TRUE(seen.insert(t).second) << t;
                EXPECT_EQ(surface.pieces.piece_of(t), p);
                const TriangleCorners corners = surface.features.corners(static_cast<std::size_t>(t));
                for (const PieceVertex& v : piece.vertices) {
                    const double before =
                        unit_normal(corners).dot(surface.features.vertex(v.vertex) - corners[0]);
                    EXPECT_LE(before, ConvexPieces::flat_within + 1e-9);
                }
                const auto& of = surface.features.of(static_cast<std::size_t>(t)).vertices;
                vertices.insert(of.begin(), of.end());
            }
            EXPECT_EQ(vertices.size(), piece.vertices.size());
            for (const PieceVertex& v : piece.vertices) {
                EXPECT_TRUE(vertices.contains(v.vertex));
                EXPECT_EQ(surface.features.of(static_cast<std::size_t>(v.triangle))
                              .vertices[static_cast<std::size_t>(v.corner)],
                          v.vertex);
            }
        }
        EXPECT_EQ(seen.size(), mesh.triangles.size());
    }
}

TEST(ConvexPieces, of_a_convex_surface_are_one_up_to_their_largest_size) {
    EXPECT_EQ(Surface(box({0, 0, 0}, {3, 2, 1})).pieces.count(), 1U);
    const TriangleMesh ball = sample::sphere_surface({0, 0, 0}, 10, 3);  // 512 triangles
    const Surface cut(ball);
    EXPECT_GE(cut.pieces.count(), 2U);
    EXPECT_LE(cut.pieces.count(), 4U);
    EXPECT_EQ(cut.pieces.piece(0).triangles.size(), ConvexPieces::most_triangles);
}

TEST(ConvexPieces, a_node_has_its_triangles_in_its_ball_and_tells_the_piece_where_they_are_of_one) {
    const Surface surface(bumpy_ball(10, 2, 0.15));
    std::set<std::int32_t> seen;
    const auto walk = [&](const auto& self, std::int32_t index, std::vector<PieceNode> above) -> void {
        const PieceNode& node = surface.pieces.node(index);
        EXPECT_TRUE(above.empty() || above.back().piece < 0 || node.piece == above.back().piece);
        above.push_back(node);
        if (node.left >= 0) {
            self(self, node.left, above);
            self(self, node.left + 1, above);
            return;
        }
        EXPECT_TRUE(seen.insert(node.triangle).second);
        EXPECT_EQ(node.piece, surface.pieces.piece_of(node.triangle));
        for (const PieceNode& each : above)
            for (const Vector3d& corner : surface.features.corners(static_cast<std::size_t>(node.triangle)))
                EXPECT_LE((corner - Vector3d(each.centre[0], each.centre[1], each.centre[2])).norm(),
                          each.radius);
    };
    walk(walk, 0, {});
    EXPECT_EQ(seen.size(), surface.features.triangle_count());
}

TEST(ConvexPieces, a_triangle_without_area_is_one_of_its_own) {
    TriangleMesh mesh = box({0, 0, 0}, {3, 2, 1});
    for (const double x : {4.0, 5.0, 6.0}) mesh.vertices.emplace_back(x, 0, 0);
    mesh.triangles.push_back({8, 9, 10});
    const Surface surface(mesh);
    EXPECT_EQ(surface.pieces.count(), 2U);
    EXPECT_EQ(surface.pieces.piece(1).vertices.size(), 3U);
}

TEST(ConvexPieces, refuse_a_surface_without_triangles) {
    const SurfaceFeatures none({}, {});
    EXPECT_THROW(ConvexPieces{none}, InvalidInput);
}

// Ten thousand random poses of two pieces, wherever the search begins.
TEST(ClosestFeatures, are_as_far_apart_as_the_nearest_of_all_pairs_of_triangles) {
    const Surface a(bumpy_ball(4, 2, 0.2)), b(bumpy_ball(10, 2, 0.15)), c(ring(10, 3, 24, 12)),
        d(box({-2, -1, 0}, {2, 1, 20}));
    std::mt19937 random(11);
    std::uniform_real_distribution<double> away(6, 22);
    std::size_t met = 0;
    const int poses = samples_of(10'000);
    for (int pose = 0; pose < poses; ++pose) {
        const Surface &mine = pose % 2 == 0 ? a : d, &its = pose % 3 == 0 ? b : c;
        const Isometry3d X = any_placement(away(random), random);
        const auto any_of = [&](std::size_t count) {
            return std::uniform_int_distribution<std::int32_t>(0,
                                                               static_cast<std::int32_t>(count) - 1)(random);
        };
        PiecePair pair{any_of(mine.pieces.count()), any_of(its.pieces.count()), {}, {}};
        const auto start = [&](const ConvexPiece& piece) {
            return piece.triangles[static_cast<std::size_t>(any_of(piece.triangles.size()))];
        };
        pair.on_a.triangle = start(mine.pieces.piece(pair.piece_a));
        pair.on_b.triangle = start(its.pieces.piece(pair.piece_b));
        const double least = apart(mine, X, its, pair);
        const TrianglePair found = closest_features(mine.pieces, X, its.pieces, 100, pair).points;
        ASSERT_NEAR(std::sqrt(found.on_a.squared_distance), least, 1e-9) << pose;
        EXPECT_EQ(mine.pieces.piece_of(pair.on_a.triangle), pair.piece_a);
        EXPECT_EQ(its.pieces.piece_of(pair.on_b.triangle), pair.piece_b);
        ASSERT_NEAR((found.on_a.point - found.on_b.point).norm(), least, 1e-9) << pose;
        met += least == 0;
    }
    EXPECT_GT(met, static_cast<std::size_t>(poses) / 1000);
    EXPECT_LT(met, static_cast<std::size_t>(poses) / 2);
}

TEST(ClosestFeatures, beyond_what_is_asked_are_known_to_be_no_nearer_than_is_said) {
    const Surface a(ring(10, 3, 24, 12)), b(ring(9, 2, 20, 10));
    std::mt19937 random(12);
    std::size_t beyond = 0;
    for (int pose = 0; pose < samples_of(40); ++pose) {
        const Isometry3d X = any_placement(9, random);
        for (std::int32_t p = 0; p < 5; ++p) {
            PiecePair pair{p, 0, {a.pieces.piece(p).triangles[0]}, {b.pieces.piece(0).triangles[0]}};
            const double least = apart(a, X, b, pair);
            const ClosestFeatures found = closest_features(a.pieces, X, b.pieces, 1, pair);
            ASSERT_LE(found.at_least, least + 1e-9);
            ASSERT_GE(found.at_least, std::min(least, 1.0) - 1e-9);
            const double apart_there = std::sqrt(found.points.on_a.squared_distance);
            ASSERT_NEAR(std::min(apart_there, 1.0), std::min(least, 1.0), 1e-9);
            beyond += least > 1;
        }
    }
    EXPECT_GT(beyond, 10U);
}

// A tool that moves and turns a little from pose to pose: the search goes on where it was.
TEST(ClosestFeatures, that_are_followed_along_a_way_are_those_of_all_triangles) {
    const Surface tool(bumpy_ball(4, 2, 0.2)), bone(bumpy_ball(10, 2, 0.15));
    std::mt19937 random(13);
    Isometry3d X = any_placement(15, random);
    PiecePair pair{0, 0, {tool.pieces.piece(0).triangles[0]}, {bone.pieces.piece(0).triangles[0]}};
    std::normal_distribution<double> component(0, 1);
    const auto vector = [&] { return Vector3d(component(random), component(random), component(random)); };
    for (int step = 0; step < samples_of(2000); ++step) {
        X.linear() = Eigen::AngleAxisd(0.02 * component(random), vector().normalized()) * X.linear();
        X.translation() += 0.1 * vector();
        const double found =
            std::sqrt(closest_features(tool.pieces, X, bone.pieces, 100, pair).points.on_a.squared_distance);
        ASSERT_NEAR(found, apart(tool, X, bone, pair), 1e-9) << step;
    }
}

TEST(EquallyNearVertices, of_a_box_over_a_plate_are_its_four_corners) {
    const Surface tool(box({-1, -1, 0}, {1, 1, 40})), plate(box({-20, -20, -10}, {20, 20, 0}));
    Isometry3d X = Isometry3d::Identity();
    X.translation() = Vector3d(3, 4, 0.2);
    PiecePair pair;
    const TrianglePair nearest = closest_features(tool.pieces, X, plate.pieces, 1, pair).points;
    std::vector<NearTriangles> found(64);
    const std::size_t count = equally_near_vertices(tool.pieces, X, plate.pieces, pair, nearest, found);
    std::set<std::pair<double, double>> corners;
    for (const NearTriangles& near : std::span(found).first(count)) {
        EXPECT_NEAR(near.points.on_a.point.z(), 0.2, 1e-12);
        EXPECT_NEAR(near.points.on_b.point.z(), 0, 1e-12);
        corners.emplace(near.points.on_a.point.x(), near.points.on_a.point.y());
    }
    EXPECT_EQ(count, 4U);
    EXPECT_EQ(corners, (std::set<std::pair<double, double>>{{2, 3}, {2, 5}, {4, 3}, {4, 5}}));
    EXPECT_EQ(equally_near_vertices(tool.pieces, X, plate.pieces, pair, nearest, std::span(found).first(2)),
              2U);
    // Over the plate's rim: the two that lie over the plate.
    X.translation().x() = 20;
    const TrianglePair rim = closest_features(tool.pieces, X, plate.pieces, 1, pair).points;
    EXPECT_EQ(equally_near_vertices(tool.pieces, X, plate.pieces, pair, rim, found), 2U);
}

}  // namespace
}  // namespace palpate
