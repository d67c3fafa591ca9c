// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "formats/model/label_map.hpp"

namespace palpate::meshing {

/// The regions of a body cut out of a label map: a grid that leaves a margin around them, also beyond the
/// image, where everything is outside.
struct RegionLabels {
    ImageGrid grid;
    std::vector<std::uint8_t> regions;  ///< per voxel: 0 outside the body, k for values[k - 1]
    std::vector<std::int32_t> values;   ///< label value of each region, ascending
};

/// Cuts out the regions with `margin` mm on every side. Throws InvalidInput if a value has no voxel, occurs
/// twice, or there are none or more than 255.
RegionLabels cut_out_regions(const LabelMap& map, std::span<const std::int32_t> values, double margin);

/// A face-connected set of voxels of one region (or of the outside).
struct LabelComponent {
    std::uint8_t region = 0;
    std::int64_t voxels = 0;
    Eigen::Vector3d centroid = Eigen::Vector3d::Zero();  ///< p_P, mm
};

struct LabelComponents {
    std::vector<LabelComponent> components;  ///< in order of their first voxel
    std::vector<std::int32_t> component_of;  ///< per voxel
};

/// Finds the face-connected components of every region and of the outside. Cost: O(voxels).
LabelComponents find_components(const RegionLabels& labels);

/// Gives every component smaller than `min_volume` mm³ to the region that most of its faces touch: specks
/// vanish, pinholes close. Returns the number of components given away.
std::int64_t absorb_specks(RegionLabels& labels, double min_volume);

}  // namespace palpate::meshing
