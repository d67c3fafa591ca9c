// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>

#include "formats/model/body.hpp"

namespace palpate::experiments {

/// A soft ellipsoid about the origin, of 3 kPa.
struct Ellipsoid {
    Eigen::Vector3d semi_axes;  ///< mm
    double spacing;             ///< of its nodes, mm
    double poissons_ratio;
    double held_side;  ///< -1: the fifth of its height that lies lowest along z is held; 1: that which lies
                       ///< highest
};

/// Meshes and condenses an ellipsoid; every surface node that is not held is a contact node.
DeformableBody body_of(const Ellipsoid& shape);

/// Makes a condensed body `stiffness` times as stiff, and with `sign` -1 mirrors its surface and compliance
/// in z. The mesh and the materials stay as they were.
DeformableBody changed(DeformableBody body, double stiffness, double sign);

}  // namespace palpate::experiments
