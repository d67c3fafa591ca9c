// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>

namespace palpate::openigtlink {

/// A tool as a tracker tells of it, in LPS. OpenIGTLink's frame is RAS: converted on reading and writing,
/// nowhere else.
struct ToolPose {
    Eigen::Vector3d tip = Eigen::Vector3d::Zero();    ///< mm
    Eigen::Vector3d shaft = Eigen::Vector3d::Zero();  ///< unit, from the tip along the shaft; zero: not known
};

/// Turns the axes by half a turn about z: LPS to RAS, and RAS to LPS.
inline Eigen::Vector3d flip_lps_ras(const Eigen::Vector3d& v) {
    return {-v.x(), -v.y(), v.z()};
}

/// The rotation that stands for a shaft: its z axis goes from the shaft to the tip and beyond, as that of
/// Plus's StylusTip and 3D Slicer's needle models does; x and y by the shortest turn from the frame's axes.
/// `axis`: z, unit; zero gives the identity.
Eigen::Matrix3d rotation_with_z(const Eigen::Vector3d& axis);

}  // namespace palpate::openigtlink
