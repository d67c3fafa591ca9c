// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "runtime/collision/balls/ball_node.hpp"
#include "runtime/collision/features/surface_features.hpp"

namespace palpate::collision {

/// A part of a surface: a ball about its triangles, and a cone about all directions in which one of its
/// points can be the surface's locally nearest. In float32, rounded up.
struct ConeNode : BallNode {
    std::array<float, 3> axis{0, 0, 1};  ///< unit
    float cosine = -1, sine = 0;         ///< of the cone's half angle, at most 90 degrees; -1: any direction
};

/// A hierarchy of balls and normal cones over a surface (Johnson, Cohen 2001, "Spatialized normal cone
/// hierarchies"); a leaf is one triangle, and halves are of equal count, so that no
/// path is longer than 32 nodes. A triangle's cone holds its normal, those beyond the sharp edges
/// that belong to it and those about its vertices, and so all directions of its features; at a border any.
class NormalConeTree {
  public:
    /// `features` must outlive this. Throws InvalidInput if there is no triangle. O(n log n).
    explicit NormalConeTree(const SurfaceFeatures& features);

    const ConeNode& node(std::int32_t index) const noexcept {  ///< 0 is the root
        return nodes_[static_cast<std::size_t>(index)];
    }
    const SurfaceFeatures& features() const noexcept { return features_; }
    /// The farthest that any vertex is from the origin, mm.
    double longest_arm() const noexcept { return longest_arm_; }

  private:
    const SurfaceFeatures& features_;
    std::vector<ConeNode> nodes_;
    double longest_arm_ = 0;
};

}  // namespace palpate::collision
