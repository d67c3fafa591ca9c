// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <functional>
#include <span>
#include <string_view>
#include <vector>

#include "formats/model/label_map.hpp"
#include "formats/model/progress.hpp"
#include "formats/model/tet_mesh.hpp"

namespace palpate {

/// A finer or coarser size for one region.
struct RegionSize {
    std::int32_t region = 0;  ///< label value
    double cell_size = 0;     ///< mm
};

/// How fine and how faithful a tetrahedral mesh is. Where regions meet, the finer size holds.
struct MeshSizing {
    double cell_size = 4;           ///< mm: largest circumradius of a tetrahedron
    double facet_size = 0;          ///< mm: largest circumradius of a surface triangle; 0: as cell_size
    double facet_distance = 0;      ///< mm: largest distance of a triangle to the surface; 0: cell_size / 10
    double facet_angle_deg = 25;    ///< smallest angle of a surface triangle, up to 30
    double cell_radius_edge = 2.5;  ///< largest circumradius over shortest edge, 2 or more
    std::vector<RegionSize> regions =
        {};                 ///< regions with a size of their own; facet sizes and distances scale
    double smoothing = -1;  ///< mm, Gaussian sigma on the labels; below 0: the largest voxel edge
    double min_component_volume =
        40;                        ///< mm³: smaller specks and pinholes are absorbed by what surrounds them
    double min_dihedral_deg = 15;  ///< flatter tetrahedra are optimised
};

/// Fills regions of a label map with tetrahedra, by Delaunay refinement (CGAL Mesh_3) of the smoothed labels
/// in the patient's frame, so that any direction matrix is right and labels may touch the image's border.
/// Region interfaces are shared by the tetrahedra on both sides. Surface nodes are finally moved along their
/// normals, by less than facet_distance, so that each region has the volume of its voxels.
///
/// Every face-connected component of min_component_volume or more is in the mesh; if one got lost,
/// QualityNotMet names it. Nodes where parts of the body touch in a point or an edge only are doubled.
/// `outside_labels` holds what `map` says beyond the surface, up to two voxel diagonals away.
///
/// Throws InvalidInput for values without voxels and sizes that are not positive. Sequential: equal inputs
/// give equal bytes on every run. Cost: 25 000 tetrahedra/s, plus 0.1 s per million voxels around the
/// regions.
TetMesh tetrahedralise(const LabelMap& map, std::span<const std::int32_t> region_values,
                       const MeshSizing& sizing, const ProgressCallback& progress = {});

}  // namespace palpate
