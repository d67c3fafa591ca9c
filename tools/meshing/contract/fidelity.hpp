// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "formats/model/tet_mesh.hpp"
#include "formats/model/triangle_mesh.hpp"
#include "tools/meshing/labels/region_labels.hpp"
#include "tools/meshing/labels/smoothed_labels.hpp"

namespace palpate::meshing {

/// Paints a mesh onto a grid: the region of the tetrahedron that holds each voxel's centre, 0 where none
/// does. Cost: O(voxels of the tetrahedra's index boxes).
std::vector<std::int32_t> voxelise(const TetMesh& mesh, const ImageGrid& grid);

/// How well one region of a mesh, or all of them taken together, agree with their labels.
struct RegionFidelity {
    std::int32_t region = 0;          ///< label value; 0 for all together
    double label_volume = 0;          ///< mm³, voxels times voxel volume
    double volume_error_percent = 0;  ///< (mesh volume - label volume) / label volume
    double dice = 0;                  ///< of the voxelised mesh and the label, 0 ... 1
    double centroid_distance = 0;     ///< mm between the centroids of voxelised mesh and label
};

struct BodyFidelity {
    RegionFidelity body;                  ///< all regions together
    std::vector<RegionFidelity> regions;  ///< in the order of the labels' regions
};

/// Compares a mesh with the labels it was made from, as prepare_domain() cuts them out; regions come in the
/// labels' order. Throws InvalidInput if they lack one of the mesh's regions.
BodyFidelity compare(const TetMesh& mesh, const RegionLabels& labels);

/// The same where `painted` is voxelise(mesh, labels.grid) already.
BodyFidelity compare(const TetMesh& mesh, const RegionLabels& labels, std::span<const std::int32_t> painted);

/// A point of one surface and its distance to another.
struct FarPlace {
    Eigen::Vector3d p_P;  ///< mm
    double distance;      ///< mm
};

/// How far the triangles around a region are from the surface of its labels, both ways, mm.
struct RegionDistance {
    std::int32_t region = 0;                             ///< label value
    double mean = 0;                                     ///< of the two one-sided means
    double percentile_95 = 0, maximum = 0;               ///< the larger of the two sides'
    Eigen::Vector3d farthest = Eigen::Vector3d::Zero();  ///< p_P, mm, where `maximum` is
    std::vector<FarPlace> far_places;                    ///< those beyond half a voxel diagonal
};

/// The surface of each region as SmoothedLabels draw it, in the regions' order. `smoothed` are made of
/// `labels`.
std::vector<TriangleMesh> region_surfaces(const RegionLabels& labels, const SmoothedLabels& smoothed);

/// Measures every region of a mesh against its surface of region_surfaces(): how far flat triangles are from
/// it. How well the smoothed labels keep the voxels themselves, compare() tells. Samples: that surface at
/// every voxel, the mesh's triangles half a voxel diagonal apart. A region that the mesh lacks is infinitely
/// far. Cost: O(n log n) in samples.
std::vector<RegionDistance> region_distances(const TetMesh& mesh, const RegionLabels& labels,
                                             std::span<const TriangleMesh> surfaces);

}  // namespace palpate::meshing
