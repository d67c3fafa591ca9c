// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <cstdint>

#include "runtime/collision/convex/convex_pieces.hpp"
#include "runtime/collision/tree_pairs.hpp"

namespace palpate::collision {

/// A feature of a triangle: its face, or an edge or a corner by its number.
struct TriangleFeature {
    std::int32_t triangle = 0;
    Feature kind = Feature::face;
    std::uint8_t which = 0;
};

/// Two pieces, and the features on which their nearest points were found last: where the next search begins.
struct PiecePair {
    std::int32_t piece_a = 0, piece_b = 0;
    TriangleFeature on_a, on_b;
};

/// A triangle of either piece, and points of them that are near each other.
struct NearTriangles {
    std::int32_t triangle_a = 0, triangle_b = 0;
    TrianglePair points;  ///< frame B, mm
};

/// The nearest points of two pieces, where these are nearer than was asked for; otherwise any.
struct ClosestFeatures {
    TrianglePair points;  ///< frame B, mm
    double at_least = 0;  ///< mm: the pieces are no nearer to each other, to 1e-9 mm
};

/// Finds the nearest points of the triangles of two convex pieces, A's as `X_BA` has it, in frame B (mm), and
/// leaves in `pair` the features that they are on. It looks at the pair's features first and walks from there
/// to neighbours that are nearer (closest features that are followed: Lin, Canny 1991, "A fast algorithm for
/// incremental distance calculation"); one pass over the vertices of both proves that no points of two convex
/// bodies are nearer. Where that is not so, for the pieces' rims need not be convex and their faces have
/// small dents, triangles that may be nearer are asked, or the trees below the pieces. Exact to 1e-9 mm where
/// less than `within`. Some hundred nanoseconds where the features are those of last time; at worst all pairs
/// of triangles. Realtime-safe.
ClosestFeatures closest_features(const ConvexPieces& a, const Eigen::Isometry3d& X_BA, const ConvexPieces& b,
                                 double within, PiecePair& pair) noexcept;

}  // namespace palpate::collision
