// SPDX-License-Identifier: Apache-2.0
#include "runtime/collision/convex/equally_near_vertices.hpp"

#include <array>
#include <cmath>
#include <cstdint>

#include "runtime/collision/convex/placed_piece.hpp"

namespace palpate::collision {
namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr double as_near = 1e-7;  // mm

// The point of a piece nearest to p (its surface's frame, mm), walked to from one of its triangles, which
// becomes the one that it is on; where the piece's rim is not convex, one that is locally nearest.
TrianglePoint foot_on_piece(const ConvexPieces& surface, const Vector3d& p, std::int32_t& triangle) noexcept {
    constexpr int most_steps = 64;
    const auto foot_on = [&](std::int32_t t) {
        return closest_point_on_triangle(p, surface.features().corners(static_cast<std::size_t>(t)));
    };
    TrianglePoint foot = foot_on(triangle);
    bool nearer = true;
    for (int step = 0; step < most_steps && nearer; ++step) {
        const TrianglePoint from = foot;
        nearer = any_beyond(surface, triangle, from, [&](std::int32_t t) {
            const TrianglePoint there = foot_on(t);
            if (!(there.squared_distance < from.squared_distance)) return false;
            foot = there;
            triangle = t;
            return true;
        });
    }
    return foot;
}

}  // namespace

std::size_t equally_near_vertices(const ConvexPieces& a, const Isometry3d& X_BA, const ConvexPieces& b,
                                  const PiecePair& pair, const TrianglePair& nearest,
                                  std::span<NearTriangles> found) noexcept {
    const auto sides = placed_pieces(a, X_BA, b, pair);
    const std::array points{nearest.on_a.point, nearest.on_b.point};
    const std::array starts{pair.on_a.triangle, pair.on_b.triangle};
    const double distance = std::sqrt(nearest.on_a.squared_distance), within = distance + as_near;
    std::size_t count = 0;
    for (const std::size_t side : {0, 1}) {
        const PlacedPiece &of = sides[side], &other = sides[1 - side];
        const Vector3d way = of.X_own.linear() * (points[1 - side] - points[side]) / distance;
        const double least = way.dot(of.X_own * points[side]) - as_near;
        for (const PieceVertex& v : of.surface.piece(of.piece).vertices) {
            const Vector3d vertex = of.surface.features().vertex(v.vertex);
            if (!v.is_pointed || way.dot(vertex) < least) continue;
            std::int32_t triangle = starts[1 - side];
            const Vector3d p = of.X_B * vertex;
            TrianglePoint foot = foot_on_piece(other.surface, other.X_own * p, triangle);
            if (foot.squared_distance > within * within) continue;
            if (count == found.size()) return count;
            foot.point = other.X_B * foot.point;
            const TrianglePoint corner{p, Vector3d::Unit(v.corner), foot.squared_distance, Feature::vertex};
            if (side == 0)
                found[count++] = {v.triangle, triangle, {corner, foot, nearest.normal}};
            else
                found[count++] = {triangle, v.triangle, {foot, corner, nearest.normal}};
        }
    }
    return count;
}

}  // namespace palpate::collision
