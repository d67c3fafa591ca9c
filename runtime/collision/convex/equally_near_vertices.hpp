// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <span>

#include "runtime/collision/convex/closest_features.hpp"
#include "runtime/collision/convex/convex_pieces.hpp"

namespace palpate::collision {

/// Of two pieces whose nearest points are `nearest`, not zero apart, finds the pointed vertices of either
/// that are as near, to 1e-7 mm, with their feet on the other piece: where face lies on face, those corners
/// of either that lie over the other (where edges cross is not found). Two convex bodies have no other places
/// that are nearer than all beside them. Writes them to `found` as far as there is room, and returns how
/// many. Realtime-safe.
std::size_t equally_near_vertices(const ConvexPieces& a, const Eigen::Isometry3d& X_BA, const ConvexPieces& b,
                                  const PiecePair& pair, const TrianglePair& nearest,
                                  std::span<NearTriangles> found) noexcept;

}  // namespace palpate::collision
