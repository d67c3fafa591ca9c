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

/// The orientation after a rotation vector (rad, frame P). Realtime-safe.
inline Eigen::Quaterniond turned(const Eigen::Quaterniond& orientation,
                                 const Eigen::Vector3d& turn) noexcept {
    const double angle = turn.norm();
    if (!(angle > 0)) return orientation;
    return (Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle)) * orientation).normalized();
}

/// How far a motion moves a point at most that is `arm` from the tool's origin, mm. Realtime-safe.
inline double reach_of(const Twist& motion, double arm) noexcept {
    return motion.head<3>().norm() + arm * motion.tail<3>().norm();
}

/// The pose after a motion. Realtime-safe.
inline ToolPose moved(const ToolPose& pose, const Twist& motion) noexcept {
    return {pose.position + motion.head<3>(), turned(pose.orientation, motion.tail<3>())};
}

}  // namespace palpate::haptics
