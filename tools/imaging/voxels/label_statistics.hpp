// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Geometry>
#include <vector>

#include "formats/model/label_map.hpp"

namespace palpate::imaging {

/// What a label map holds of one label.
struct LabelStatistics {
    Label label;
    std::size_t voxels = 0;
    double volume_ml = 0;
    std::size_t components = 0;         ///< face-connected
    Eigen::AlignedBox3d box;            ///< of the voxel centres in P, mm
    Eigen::Vector3d centroid{0, 0, 0};  ///< of the voxel centres in P, mm
    bool at_image_edge = false;         ///< has a voxel on the image's border: what lies beyond is missing
};

/// One entry per name of the map, in its order. Cost: linear in voxels, and in each label's box.
std::vector<LabelStatistics> label_statistics(const LabelMap& map);

/// Those of the map's labels that have a voxel on the image's border, in its order. Cost: one pass.
std::vector<Label> labels_at_image_edge(const LabelMap& map);

}  // namespace palpate::imaging
