// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "formats/model/body.hpp"

namespace palpate {

/// Of the ellipsoid that is condensed: along x, y, z, about the origin, mm. A liver's size.
inline const Eigen::Vector3d ellipsoid_semi_axes{100, 70, 50};

/// Holds the tenth of an ellipsoid's surface that lies highest along z, in a soft tissue's material (3 kPa,
/// Poisson's ratio 0.45); its other surface nodes are contact nodes. Nothing is condensed yet.
DeformableBody held_ellipsoid(TetMesh mesh);

}  // namespace palpate
