// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "formats/model/label_map.hpp"
#include "formats/model/triangle_mesh.hpp"

namespace palpate::meshing {

/// Turns a closed surface (mm, LPS) into label 1 of that name, on a grid along the patient's axes with voxels
/// of `spacing` mm and three of them around it: voxels whose centre lies inside. Throws InvalidInput naming
/// the label if none does. Cost: voxels, and triangles times the slices that they span (VTK's stencil).
LabelMap voxelised(const TriangleMesh& surface, const std::string& name, double spacing);

}  // namespace palpate::meshing
