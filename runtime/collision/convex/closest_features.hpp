// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <cstdint>

#include "runtime/collision/convex/convex_pieces.hpp"
#include "runtime/collision/tree_pairs.hpp"

namespace palpate::collision {

/// Two pieces, and the triangles on which their nearest points were found last: where the next search begins.
struct PiecePair {
    std::int32_t piece_a = 0, piece_b = 0;
    std::int32_t triangle_a = 0, triangle_b = 0;
};

/// A triangle of either piece, and points of them that are near each other.
struct NearTriangles {
    std::int32_t triangle_a = 0, triangle_b = 0;
    TrianglePair points;  ///< frame B, mm
};

/// Finds the nearest points of the triangles of two convex pieces, A's as `X_BA` has it, in frame B (mm), and
/// leaves in `pair` the triangles that they are on. It walks from the pair's triangles to neighbours that are
/// nearer (closest features that are followed: Lin, Canny 1991, "A fast algorithm for incremental distance
/// calculation"), so that after a small motion it costs the same for pieces of any size but one pass over
/// their vertices, which proves that no points of two convex bodies are nearer. Where that is not so, for the
/// pieces' rims need not be convex, the trees below them are searched. Exact to 1e-9 mm where less than
/// `within`; otherwise no less than that. Realtime-safe.
TrianglePair closest_features(const ConvexPieces& a, const Eigen::Isometry3d& X_BA, const ConvexPieces& b,
                              double within, PiecePair& pair) noexcept;

}  // namespace palpate::collision
