// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>

#include "formats/model/triangle_mesh.hpp"

namespace palpate::meshing {

/// Finds where a mesh of tetrahedra that are not inverted lies over itself, from its boundary: exactly where
/// that cuts through itself, or where a piece of it lies within another, or faces inwards and within none.
/// Returns a place there, or nothing. Pieces may touch in vertices and edges that they have at the same
/// places. Cost: 0.3 s for 100 000 triangles, and triangles times pieces.
std::optional<Eigen::Vector3d> place_of_overlap(const TriangleMesh& boundary);

}  // namespace palpate::meshing
