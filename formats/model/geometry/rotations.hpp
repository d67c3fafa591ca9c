// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <cmath>

namespace palpate {

/// The rotation vector (rad) that turns `from` to `to`, the shorter way, in the frame that both turn to.
/// Realtime-safe.
inline Eigen::Vector3d rotation_between(const Eigen::Quaterniond& from,
                                        const Eigen::Quaterniond& to) noexcept {
    Eigen::Quaterniond turn = to * from.conjugate();
    if (turn.w() < 0) turn.coeffs() = -turn.coeffs();
    const double sine = turn.vec().norm();
    // 2 asin(s) / s, which is 2 where there is no turn.
    const double factor = sine > 1e-12 ? 2 * std::atan2(sine, turn.w()) / sine : 2;
    return factor * turn.vec();
}

/// The orientation after a rotation vector (rad, in the frame that the orientation turns to). Realtime-safe.
inline Eigen::Quaterniond turned(const Eigen::Quaterniond& orientation,
                                 const Eigen::Vector3d& turn) noexcept {
    const double angle = turn.norm();
    if (!(angle > 0)) return orientation;
    return (Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle)) * orientation).normalized();
}

}  // namespace palpate
