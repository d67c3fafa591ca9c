// SPDX-License-Identifier: Apache-2.0
#include "runtime/collision/balls/ball_pairs.hpp"

namespace palpate::collision {

bool may_be_near(const BallNode& a, const Eigen::Isometry3d& X_BA, const BallNode& b,
                 double within) noexcept {
    const auto centre = [](const BallNode& node) {
        return Eigen::Vector3d(node.centre[0], node.centre[1], node.centre[2]);
    };
    const double radii = static_cast<double>(a.radius) + static_cast<double>(b.radius) + within;
    return (X_BA * centre(a) - centre(b)).squaredNorm() <= radii * radii;
}

}  // namespace palpate::collision
