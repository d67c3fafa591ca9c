// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>

#include "runtime/collision/cones/normal_cone_tree.hpp"

namespace palpate::collision {

/// What two parts must hold to be looked into.
struct ConeReach {
    double within = 0;  ///< mm, between the points of a pair
    double slack = 0;   ///< mm, that the first surface's origin may move meanwhile
    double turn = 0;    ///< rad, that it may turn about it meanwhile
};

/// Whether two parts, the first as `X_BA` has it, may hold points that are locally nearest to each other:
/// their balls are near enough, and among the directions from one to the other there are some of both cones.
/// Realtime-safe.
bool may_be_nearest(const ConeNode& a, const Eigen::Isometry3d& X_BA, const ConeNode& b,
                    const ConeReach& reach) noexcept;

}  // namespace palpate::collision
