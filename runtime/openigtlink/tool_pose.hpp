// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>

namespace palpate::openigtlink {

/// A tool as a tracker tells of it, in LPS. OpenIGTLink's frame is RAS: converted on reading and writing,
/// nowhere else.
struct ToolPose {
    Eigen::Vector3d tip = Eigen::Vector3d::Zero();    ///< mm
    Eigen::Vector3d shaft = Eigen::Vector3d::Zero();  ///< unit, from the tip along the shaft; zero: not known
    Eigen::Quaterniond orientation{0, 0, 0,
                                   0};  ///< of the tool's frame, whose z is the shaft; zero: not known
};

/// Turns the axes by half a turn about z: LPS to RAS, and RAS to LPS.
inline Eigen::Vector3d flip_lps_ras(const Eigen::Vector3d& v) {
    return {-v.x(), -v.y(), v.z()};
}

/// The axes of a message of a tool whose frame is turned by R in LPS, and the other way round: RAS for LPS,
/// and half a turn about the tool's x, for a message's z goes from the shaft to the tip and beyond.
inline Eigen::Matrix3d flip_axes(const Eigen::Matrix3d& R) {
    return Eigen::Vector3d(-1, -1, 1).asDiagonal() * R * Eigen::Vector3d(1, -1, -1).asDiagonal();
}

/// The rotation that stands for a shaft: its z axis goes from the shaft to the tip and beyond, as that of
/// Plus's StylusTip and 3D Slicer's needle models does; x and y by the shortest turn from the frame's axes.
/// `axis`: z, unit; zero gives the identity.
Eigen::Matrix3d rotation_with_z(const Eigen::Vector3d& axis);

}  // namespace palpate::openigtlink
