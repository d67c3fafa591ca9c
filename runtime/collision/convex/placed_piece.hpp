// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "runtime/collision/balls/ball_pairs.hpp"
#include "runtime/collision/convex/closest_features.hpp"
#include "runtime/collision/convex/convex_pieces.hpp"
#include "runtime/collision/triangle_queries.hpp"

namespace palpate::collision {

/// One of two pieces. Realtime-safe.
struct PlacedPiece {
    const ConvexPieces& surface;
    std::int32_t piece;
    Eigen::Isometry3d X_B, X_own;  ///< from its own frame to B's, and back

    TriangleCorners own_corners(std::int32_t triangle) const noexcept {
        return surface.features().corners(static_cast<std::size_t>(triangle));
    }
    TriangleCorners corners(std::int32_t triangle) const noexcept {  ///< frame B
        return placed(X_B, own_corners(triangle));
    }
    const PieceNode& ball() const noexcept { return surface.node(surface.piece(piece).root); }
};

/// The pieces of a pair, A's as `X_BA` has it.
inline std::array<PlacedPiece, 2> placed_pieces(const ConvexPieces& a, const Eigen::Isometry3d& X_BA,
                                                const ConvexPieces& b, const PiecePair& pair) noexcept {
    const Eigen::Isometry3d identity = Eigen::Isometry3d::Identity();
    return {{{a, pair.piece_a, X_BA, X_BA.inverse()}, {b, pair.piece_b, identity, identity}}};
}

/// Calls visit(triangle) for the other triangles of a piece that share a corner, until it returns true.
template <typename Visit>
bool any_around(const ConvexPieces& surface, std::int32_t triangle, std::size_t corner,
                const Visit& visit) noexcept {
    const auto of = [&](std::int32_t t) -> const TriangleFeatures& {
        return surface.features().of(static_cast<std::size_t>(t));
    };
    const std::int32_t vertex = of(triangle).vertices[corner], piece = surface.piece_of(triangle);
    constexpr int most_around = 64;
    for (const bool onwards : {true, false}) {
        std::int32_t t = triangle;
        std::size_t at = corner;
        for (int k = 0; k < most_around; ++k) {
            t = of(t).beyond[onwards ? (at + 2) % 3 : at];
            if (t == triangle) return false;
            if (t < 0 || surface.piece_of(t) != piece) break;
            const auto& vertices = of(t).vertices;
            at = static_cast<std::size_t>(std::ranges::find(vertices, vertex) - vertices.begin());
            if (visit(t)) return true;
        }
    }
    return false;
}

/// Calls visit(triangle) for the triangles of a piece beyond the feature that a point of it lies on.
template <typename Visit>
bool any_beyond(const ConvexPieces& surface, std::int32_t triangle, const TrianglePoint& point,
                const Visit& visit) noexcept {
    if (point.feature == Feature::face) return false;
    if (point.feature == Feature::vertex) return any_around(surface, triangle, corner_of(point), visit);
    const std::int32_t t = surface.features().of(static_cast<std::size_t>(triangle)).beyond[edge_of(point)];
    return t >= 0 && surface.piece_of(t) == surface.piece_of(triangle) && visit(t);
}

}  // namespace palpate::collision
