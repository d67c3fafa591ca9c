// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <cmath>

#include "runtime/collision/cones/normal_cone_tree.hpp"

namespace palpate::collision {

/// What two parts must hold to be looked into: points so near to each other, mm, while the first surface's
/// origin may move by `slack` (mm) and the surface turn about it by `turn` (rad).
struct ConeReach {
    explicit ConeReach(double within, double slack = 0, double turn = 0) noexcept
        : within(within), slack(slack), turn(turn), cosine(std::cos(turn)), sine(std::sin(turn)) {}

    double within, slack, turn;
    double cosine, sine;  ///< of the turn
};

/// Whether two parts, the first as `X_BA` has it, may hold points that are locally nearest to each other:
/// their balls are near enough, and among the directions from one to the other there are some of both cones.
/// Realtime-safe.
bool may_be_nearest(const ConeNode& a, const Eigen::Isometry3d& X_BA, const ConeNode& b,
                    const ConeReach& reach) noexcept;

}  // namespace palpate::collision
