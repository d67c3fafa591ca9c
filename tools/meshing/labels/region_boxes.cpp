// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/labels/region_boxes.hpp"

#include <algorithm>
#include <cassert>

#include "tools/meshing/labels/gaussian.hpp"

namespace palpate::meshing {

std::vector<RegionBox> region_boxes(const RegionLabels& labels, const Index3& reach) {
    std::vector<Index3> low(labels.values.size(), labels.grid.size);
    std::vector<Index3> high(labels.values.size(), Index3{-1, -1, -1});
    for_each_voxel({{}, labels.grid.size}, [&](const Index3& voxel, std::size_t offset) {
        if (labels.regions[offset] == 0) return;
        const std::size_t region = labels.regions[offset] - 1U;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            low[region][axis] = std::min(low[region][axis], voxel[axis]);
            high[region][axis] = std::max(high[region][axis], voxel[axis]);
        }
    });
    std::vector<RegionBox> boxes(low.size());
    for (std::size_t region = 0; region < boxes.size(); ++region)
        for (std::size_t axis = 0; axis < 3; ++axis) {
            assert(low[region][axis] <= high[region][axis]);
            boxes[region].low[axis] = low[region][axis] - reach[axis];
            boxes[region].size[axis] = high[region][axis] - low[region][axis] + 1 + 2 * reach[axis];
        }
    return boxes;
}

std::vector<float> smoothed_indicator(const RegionLabels& labels, std::uint8_t region, const RegionBox& box,
                                      const std::array<double, 3>& sigma_voxels) {
    FloatImage image{box.size, sigma_voxels, {}};
    image.values.reserve(static_cast<std::size_t>(box.size[0]) * static_cast<std::size_t>(box.size[1]) *
                         static_cast<std::size_t>(box.size[2]));
    for_each_voxel(box, [&](const Index3& v, std::size_t) {
        image.values.push_back(labels.regions[labels.grid.offset(v[0], v[1], v[2])] == region ? 1.0F : 0.0F);
    });
    smooth(image);
    return std::move(image.values);
}

}  // namespace palpate::meshing
