// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>

#include "formats/model/geometry/rotations.hpp"

namespace palpate::haptics {

/// Where a tool that turns is.
struct ToolPose {
    Eigen::Vector3d position{0, 0, 0};                               ///< of its tip's centre, p_P, mm
    Eigen::Quaterniond orientation{Eigen::Quaterniond::Identity()};  ///< R_PT
};

/// A small motion of a tool: its tip's way (mm), then its rotation vector (rad), both in frame P.
using Twist = Eigen::Matrix<double, 6, 1>;

/// How far a motion moves a point at most that is `arm` from the tool's origin, mm. Realtime-safe.
inline double reach_of(const Twist& motion, double arm) noexcept {
    return motion.head<3>().norm() + arm * motion.tail<3>().norm();
}

/// X_PT of a pose. Realtime-safe.
inline Eigen::Isometry3d placement_of(const ToolPose& pose) noexcept {
    Eigen::Isometry3d X_PT = Eigen::Isometry3d::Identity();
    X_PT.linear() = pose.orientation.toRotationMatrix();
    X_PT.translation() = pose.position;
    return X_PT;
}

/// How far a tool moves and turns: its origin, mm, and about it, rad.
struct Motion {
    double way = 0, turn = 0;

    /// How far a point moves at most that is no farther than `arm` from the origin, mm.
    double of(double arm) const noexcept { return way + arm * turn; }
    Motion& operator+=(const Motion& more) noexcept {
        way += more.way;
        turn += more.turn;
        return *this;
    }
};
/// From one pose to another, the shorter way. Realtime-safe.
inline Motion motion_between(const ToolPose& from, const ToolPose& to) noexcept {
    return {(to.position - from.position).norm(), rotation_between(from.orientation, to.orientation).norm()};
}

/// The pose after a motion. Realtime-safe.
inline ToolPose moved(const ToolPose& pose, const Twist& motion) noexcept {
    return {pose.position + motion.head<3>(), turned(pose.orientation, motion.tail<3>())};
}

}  // namespace palpate::haptics
