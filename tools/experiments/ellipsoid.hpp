// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "formats/model/body.hpp"
#include "tools/fem/assembly/node_rules.hpp"

namespace palpate::experiments {

/// Of the ellipsoid that is condensed: along x, y, z, about the origin, mm. A liver's size.
inline const Eigen::Vector3d ellipsoid_semi_axes{100, 70, 50};

/// Holds the tenth of the ellipsoid's surface that lies highest along z.
inline const fem::NodeRule ellipsoid_support{"plane:0,0,42,0,0,1", fem::BeyondPlane{{0, 0, 42}, {0, 0, 1}}};

/// Makes a body of soft tissue (3 kPa, Poisson's ratio 0.45 in every region) of a mesh, held by `rule`; the
/// other surface nodes are contact nodes. Nothing is condensed yet. Throws as fixed_nodes_of().
DeformableBody held_body(TetMesh mesh, const fem::NodeRule& rule);

}  // namespace palpate::experiments
