// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "formats/model/label_map.hpp"
#include "formats/model/tet_mesh.hpp"

namespace palpate::meshing {

/// Tells for every node what `map` says beyond the surface: the first label that is none of the body's
/// regions on a walk along the outward normal, at most two voxel diagonals long; if the walk meets none, the
/// nearest such label in any direction within that distance; 0 for background, -1 for interior nodes.
std::vector<std::int32_t> outside_labels(const TetMesh& mesh, const LabelMap& map);

}  // namespace palpate::meshing
