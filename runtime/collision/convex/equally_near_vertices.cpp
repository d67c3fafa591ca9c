// SPDX-License-Identifier: Apache-2.0
#include "runtime/collision/convex/equally_near_vertices.hpp"

#include <cmath>
#include <cstdint>

#include "runtime/collision/convex/piece_steps.hpp"

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

// Vertices of piece `piece` of one surface against the other, on which the search begins at `start`. `point`
// is the piece's nearest point and `way` the unit vector from there to the other, both in the piece's frame.
struct Side {
    const ConvexPieces &of, &other;
    const Isometry3d& X;  // from the piece's frame to the other's
    std::int32_t piece, start;
    Vector3d point, way;
};

// Calls tell(vertex of the piece, its place in the other's frame, foot, triangle of the foot).
template <typename Tell>
void look_from(const Side& side, double distance, const Tell& tell) noexcept {
    const double least = side.way.dot(side.point) - as_near, within = distance + as_near;
    for (const PieceVertex& v : side.of.piece(side.piece).vertices) {
        if (!v.is_pointed) continue;
        const Vector3d vertex = side.of.features().vertex(v.vertex);
        if (side.way.dot(vertex) < least) continue;
        std::int32_t triangle = side.start;
        const Vector3d p = side.X * vertex;
        const TrianglePoint foot = foot_on_piece(side.other, p, triangle);
        if (foot.squared_distance <= within * within) tell(v, vertex, p, foot, triangle);
    }
}

TrianglePoint at_corner(const PieceVertex& v, const Vector3d& p, double squared_distance) noexcept {
    return {p, Vector3d::Unit(v.corner), squared_distance, Feature::vertex};
}

}  // namespace

std::size_t equally_near_vertices(const ConvexPieces& a, const Isometry3d& X_BA, const ConvexPieces& b,
                                  const PiecePair& pair, const TrianglePair& nearest,
                                  std::span<NearTriangles> found) noexcept {
    const double distance = std::sqrt(nearest.on_a.squared_distance);
    const Vector3d way = (nearest.on_b.point - nearest.on_a.point) / distance;  // from a to b
    const Isometry3d X_AB = X_BA.inverse();
    std::size_t count = 0;
    const Side from_a{
        a, b, X_BA, pair.piece_a, pair.on_b.triangle, X_AB * nearest.on_a.point, X_AB.linear() * way};
    look_from(
        from_a, distance,
        [&](const PieceVertex& v, const Vector3d&, const Vector3d& p, const TrianglePoint& foot,
            std::int32_t triangle) {
            if (count == found.size()) return;
            found[count++] = {v.triangle, triangle, {at_corner(v, p, foot.squared_distance), foot, way}};
        });
    const Side from_b{b, a, X_AB, pair.piece_b, pair.on_a.triangle, nearest.on_b.point, -way};
    look_from(
        from_b, distance,
        [&](const PieceVertex& v, const Vector3d& vertex, const Vector3d&, TrianglePoint foot,
            std::int32_t triangle) {
            if (count == found.size()) return;
            foot.point = X_BA * foot.point;
            found[count++] = {triangle, v.triangle, {foot, at_corner(v, vertex, foot.squared_distance), way}};
        });
    return count;
}

}  // namespace palpate::collision
