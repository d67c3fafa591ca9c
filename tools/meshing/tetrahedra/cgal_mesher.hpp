// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <span>

#include "formats/model/progress.hpp"
#include "formats/model/tet_mesh.hpp"
#include "tools/meshing/labels/smoothed_labels.hpp"
#include "tools/meshing/tetrahedra/size_field.hpp"
#include "tools/meshing/tetrahedra/surface_seeds.hpp"

namespace palpate::meshing {

/// Shape bounds of Delaunay refinement and of the optimisation after it.
struct DelaunayShape {
    double facet_angle_deg = 25;    ///< smallest angle of a surface triangle, up to 30
    double cell_radius_edge = 2.5;  ///< largest circumradius over shortest edge, 2 or more
    double min_dihedral_deg = 15;   ///< flatter tetrahedra are exuded
};

/// Meshes smoothed labels from the given surface seeds; `regions` of the result are region numbers 1, 2, ...
/// Triangles that cut an edge or a tip off, by more than twice the distance that `sizes` asks for or by more
/// than `max_gap` mm, are made smaller; their sizes are added to `sizes`.
/// Only positions, tetrahedra and regions are filled in; every node is used, every volume positive.
TetMesh mesh_smoothed_labels(const SmoothedLabels& labels, std::span<const SurfaceSeed> seeds,
                             SizeField& sizes, double max_gap, const DelaunayShape& shape,
                             const ProgressCallback& progress);

}  // namespace palpate::meshing
