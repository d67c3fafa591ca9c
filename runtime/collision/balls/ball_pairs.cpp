// SPDX-License-Identifier: Apache-2.0
#include "runtime/collision/balls/ball_pairs.hpp"

#include <cmath>

namespace palpate::collision {
namespace {

double squared_between_centres(const BallNode& a, const Eigen::Isometry3d& X_BA, const BallNode& b) noexcept {
    const auto centre = [](const BallNode& node) {
        return Eigen::Vector3d(node.centre[0], node.centre[1], node.centre[2]);
    };
    return (X_BA * centre(a) - centre(b)).squaredNorm();
}

double radii(const BallNode& a, const BallNode& b) noexcept {
    return static_cast<double>(a.radius) + static_cast<double>(b.radius);
}

}  // namespace

bool may_be_near(const BallNode& a, const Eigen::Isometry3d& X_BA, const BallNode& b,
                 double within) noexcept {
    const double reach = radii(a, b) + within;
    return squared_between_centres(a, X_BA, b) <= reach * reach;
}

double least_apart(const BallNode& a, const Eigen::Isometry3d& X_BA, const BallNode& b) noexcept {
    return std::sqrt(squared_between_centres(a, X_BA, b)) - radii(a, b);
}

}  // namespace palpate::collision
