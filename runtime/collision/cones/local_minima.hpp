// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <limits>

#include "runtime/collision/features/surface_features.hpp"

namespace palpate::collision {

/// A pair of points, one on each of two surfaces that are apart, that are nearer to each other than any
/// beside them: each is its surface's locally nearest in the direction of the other. In frame B.
struct LocalMinimum {
    Eigen::Vector3d on_a{0, 0, 0}, on_b{0, 0, 0};  ///< mm
    double distance = 0;                           ///< mm, above zero
};

/// A triangle of a surface A that lies in frame B as X_BA has it, and one of a surface B.
struct FeaturePair {
    const SurfaceFeatures& a;
    const SurfaceFeatures& b;
    std::size_t triangle_a, triangle_b;
    const Eigen::Isometry3d& X_BA;
    const TriangleCorners& corners_a;  ///< in frame B, mm
    const TriangleCorners& corners_b;
};

/// Most local minima between what belongs to two triangles: vertices of either on the other, and edges.
inline constexpr std::size_t most_minima_of_pair = 3 + 3 + 9;

/// What a pair of triangles has.
struct PairMinima {
    std::size_t count = 0;                                   ///< of `minima`
    std::array<LocalMinimum, most_minima_of_pair> minima;    ///< in the order of A's features
    double least = std::numeric_limits<double>::infinity();  ///< mm, of all distances that were asked
};

/// Writes to `found` the local minima of the distance, no farther than `within` (mm), between what belongs to
/// the two triangles, and the least distance of these: vertices and triangles of either, and convex edges of
/// both. What triangles share belongs to one of them, so that over all pairs each minimum is found once.
/// Realtime-safe.
void local_minima(const FeaturePair& pair, double within, PairMinima& found) noexcept;

}  // namespace palpate::collision
