// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <span>

#include "formats/model/tet_mesh.hpp"
#include "tools/meshing/smoothed_labels.hpp"
#include "tools/meshing/surface_seeds.hpp"
#include "tools/meshing/tetrahedralise.hpp"

namespace palpate {

/// Sizes of one region in mm, as MeshSizing explains them.
struct RegionSizing {
    double cell_size, facet_size, facet_distance;
};

/// Meshes smoothed labels from the given surface seeds; `regions` of the result are region numbers 1, 2, ...
/// Only positions, tetrahedra and regions are filled in; every node is used, every volume positive.
TetMesh mesh_smoothed_labels(const SmoothedLabels& labels, std::span<const SurfaceSeed> seeds,
                             std::span<const RegionSizing> region_sizing, const MeshSizing& sizing,
                             const ProgressCallback& progress);

}  // namespace palpate
