// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "runtime/collision/convex/convex_pieces.hpp"
#include "runtime/collision/triangle_queries.hpp"

namespace palpate::collision {

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
