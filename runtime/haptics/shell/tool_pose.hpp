// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <cmath>

namespace palpate::haptics {

/// Where a tool that turns is.
struct ToolPose {
    Eigen::Vector3d position{0, 0, 0};                               ///< of its tip's centre, p_P, mm
    Eigen::Quaterniond orientation{Eigen::Quaterniond::Identity()};  ///< R_PT
};

/// A small motion of a tool: its tip's way (mm), then its rotation vector (rad), both in frame P.
using Twist = Eigen::Matrix<double, 6, 1>;

/// The rotation vector (rad, frame P) that turns `from` to `to`, the shorter way. Realtime-safe.
inline Eigen::Vector3d rotation_between(const Eigen::Quaterniond& from,
                                        const Eigen::Quaterniond& to) noexcept {
    Eigen::Quaterniond turn = to * from.conjugate();
    if (turn.w() < 0) turn.coeffs() = -turn.coeffs();
    const double sine = turn.vec().norm();
    // 2 asin(s) / s, which is 2 where there is no turn.
    const double factor = sine > 1e-12 ? 2 * std::atan2(sine, turn.w()) / sine : 2;
    return factor * turn.vec();
}

/// A motion that only turns, rad.
inline Twist rotation(const Eigen::Vector3d& turn) noexcept {
    Twist motion = Twist::Zero();
    motion.tail<3>() = turn;
    return motion;
}

/// The pose after a motion. Realtime-safe.
inline ToolPose moved(const ToolPose& pose, const Twist& motion) noexcept {
    const Eigen::Vector3d turn = motion.tail<3>();
    const double angle = turn.norm();
    ToolPose after = pose;
    after.position += motion.head<3>();
    if (angle > 0)
        after.orientation =
            (Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle)) * pose.orientation).normalized();
    return after;
}

}  // namespace palpate::haptics
