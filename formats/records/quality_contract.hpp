// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "formats/records/field.hpp"

namespace palpate {

/// What a mesh must keep to be trusted. Limits in mm hold for voxels of up to 1 mm³ and grow with the cube
/// root of larger ones.
struct QualityContract {
    double min_dihedral_deg = 12;
    double max_dihedral_deg = 165;
    double max_volume_error_percent = 1;
    double max_mean_distance = 0.25;  // mm
    double max_p95_distance = 0.5;    // mm
    double max_distance = 1;          // voxel diagonals
    double min_dice = 0.98;
    double min_region_dice = 0.95;
    double max_centroid_distance = 0.05;  // mm
};

inline constexpr Range fraction{.least = 0, .most = 1};

inline constexpr std::tuple quality_fields{
    Field("min_dihedral_deg", &QualityContract::min_dihedral_deg, "degrees", "smallest dihedral angle",
          Range{.least = 0, .most = 180}),
    Field("max_dihedral_deg", &QualityContract::max_dihedral_deg, "degrees", "largest dihedral angle",
          Range{.least = 0, .most = 180}),
    Field("max_volume_error_percent", &QualityContract::max_volume_error_percent, "%",
          "volume of a region against its voxels", not_negative),
    Field("max_mean_distance", &QualityContract::max_mean_distance, "mm",
          "mean distance of a region's triangles and its labels' surface", not_negative),
    Field("max_p95_distance", &QualityContract::max_p95_distance, "mm", "95th percentile of that distance",
          not_negative),
    Field("max_distance", &QualityContract::max_distance, "voxel diagonals", "largest such distance",
          not_negative),
    Field("min_dice", &QualityContract::min_dice, "",
          "overlap of the re-voxelised body and its labels, 0 to 1", fraction),
    Field("min_region_dice", &QualityContract::min_region_dice, "",
          "overlap of each re-voxelised region and its label, 0 to 1", fraction),
    Field("max_centroid_distance", &QualityContract::max_centroid_distance, "mm",
          "distance of the centroids of body and labels", not_negative)};

}  // namespace palpate
