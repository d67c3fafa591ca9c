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
#include "tools/meshing/labels/smoothed_labels.hpp"

namespace palpate::meshing {

/// Sizes of one region that differ from those of the body.
struct RegionSize {
    std::int32_t region = 0;   ///< label value
    double cell_size = 0;      ///< mm; 0: that of the body, or the region's own radius if that is less
    double surface_scale = 1;  ///< multiplies the sizes and distances of the region's triangles
};

/// A finer size near a place.
struct NearSize {
    std::vector<Eigen::Vector3d> points;  ///< p_P, mm; none: near the label
    std::int32_t label = 0;               ///< label value, of a region or of a neighbour
    double within = 0;                    ///< mm: as far as this the size holds
    double cell_size = 0;                 ///< mm
};

/// How fine and how faithful a tetrahedral mesh is. Where regions meet, the finer size holds.
struct MeshSizing {
    double cell_size = 4;       ///< mm: largest circumradius of a tetrahedron
    double facet_size = 0;      ///< mm: largest circumradius of a surface triangle; 0: as cell_size
    double facet_distance = 0;  ///< mm: largest distance of a triangle to the surface; 0: cell_size / 10
    double max_gap = 0;  ///< mm: how far a triangle may cut an edge or a tip off; 0: 0.6 voxel diagonals
    double facet_angle_deg = 25;           ///< smallest angle of a surface triangle, up to 30
    double cell_radius_edge = 2.5;         ///< largest circumradius over shortest edge, 2 or more
    std::vector<RegionSize> regions = {};  ///< facet sizes and distances scale with the cell size
    std::vector<NearSize> near = {};       ///< likewise near points and labels
    double smoothing = -1;  ///< mm, Gaussian sigma on the labels; below 0: the largest voxel edge
    double min_component_volume =
        40;                        ///< mm³: smaller specks and pinholes are absorbed by what surrounds them
    double min_dihedral_deg = 15;  ///< flatter tetrahedra are optimised
};

/// What a label map's regions become before they are meshed.
struct MeshDomain {
    RegionLabels labels;      ///< cut out, specks absorbed
    SmoothedLabels smoothed;  ///< whose surfaces are meshed
};

/// Throws InvalidInput for sizes and distances below a thousandth of a voxel's smallest edge, where nothing
/// but round-off is left to mesh.
void require_coarser_than_round_off(const MeshSizing& sizing, const ImageGrid& grid);

/// Cuts regions out of a label map and smooths them. Throws InvalidInput for values without voxels, and for a
/// region that has no piece of `min_component_volume` mm³.
MeshDomain prepare_domain(const LabelMap& map, std::span<const std::int32_t> region_values, double smoothing,
                          double min_component_volume);

/// Fills regions of a label map with tetrahedra, by Delaunay refinement (CGAL Mesh_3) of the smoothed labels
/// in the patient's frame, so that any direction matrix is right and labels may touch the image's border.
/// Region interfaces are shared by the tetrahedra on both sides. Surface nodes are finally fitted, so that
/// the triangles lie about the surface and each region has the volume of its voxels.
///
/// Every face-connected component of min_component_volume or more is seeded. Nodes where parts of the body
/// touch in a point or an edge only are doubled. `outside_labels` holds what `map` says beyond the surface,
/// up to two voxel diagonals away.
///
/// Throws InvalidInput for values without voxels, sizes that are not positive, and sizes, distances and
/// places for which more than 20 million tetrahedra are to be expected. Sequential: equal inputs give equal
/// bytes on every run. Cost: tests/benchmarks/README.md.
TetMesh tetrahedralise(const LabelMap& map, std::span<const std::int32_t> region_values,
                       const MeshSizing& sizing, const ProgressCallback& progress = {});

/// The same from a prepared domain of `map`.
TetMesh tetrahedralise(const MeshDomain& domain, const LabelMap& map, const MeshSizing& sizing,
                       const ProgressCallback& progress = {});

}  // namespace palpate::meshing
