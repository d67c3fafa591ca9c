// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "formats/model/tet_mesh.hpp"

namespace palpate {

/// Holds surface nodes beyond which lies the label of this name; "background" means no label.
struct TouchingLabel {
    std::string name;
};
/// Holds surface nodes inside an axis-parallel box, LPS mm.
struct InsideBox {
    Eigen::Vector3d lower, upper;
};
/// Holds surface nodes inside a sphere, LPS mm.
struct InsideSphere {
    Eigen::Vector3d center;
    double radius;
};
/// Holds surface nodes on the side of a plane that its normal points to, LPS mm.
struct BeyondPlane {
    Eigen::Vector3d point, normal;
};
using FixedRule = std::variant<TouchingLabel, InsideBox, InsideSphere, BeyondPlane>;

/// Reads "touching:skull", "box:x0,y0,z0,x1,y1,z1", "sphere:x,y,z,r" or "plane:x,y,z,nx,ny,nz" (LPS mm).
/// Throws UsageError.
FixedRule parse_fixed_rule(std::string_view text);

/// Returns the surface nodes that any rule holds, ascending. Throws InvalidInput if a rule names an unknown
/// label or holds no node.
std::vector<std::int32_t> fixed_nodes_of(const TetMesh& mesh, const BoundarySurface& boundary,
                                         std::span<const FixedRule> rules);

/// Throws InvalidInput naming the motion if any connected part of the mesh could still move rigidly: no held
/// node (all six motions), one (rotations about it), or all on a line (rotation about it).
void require_no_rigid_motion(const TetMesh& mesh, std::span<const std::int32_t> fixed_nodes);

}  // namespace palpate
