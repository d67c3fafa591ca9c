// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "tools/meshing/labels/region_labels.hpp"

namespace palpate::meshing {

using Index3 = std::array<std::int32_t, 3>;

/// A box of voxels.
struct RegionBox {
    Index3 low{}, size{};
};

/// Calls visit(voxel, offset in the box), i fastest.
template <typename Visit>
void for_each_voxel(const RegionBox& box, Visit&& visit) {
    std::size_t offset = 0;
    for (std::int32_t k = box.low[2]; k < box.low[2] + box.size[2]; ++k)
        for (std::int32_t j = box.low[1]; j < box.low[1] + box.size[1]; ++j)
            for (std::int32_t i = box.low[0]; i < box.low[0] + box.size[0]; ++i)
                visit(Index3{i, j, k}, offset++);
}

/// Returns the box of every region with `reach` voxels more on each side, in the regions' order.
/// Precondition: every region has a voxel (asserted).
std::vector<RegionBox> region_boxes(const RegionLabels& labels, const Index3& reach);

/// Returns 1 where the region is and 0 elsewhere, smoothed by a Gaussian, over a box inside the labels' grid.
std::vector<float> smoothed_indicator(const RegionLabels& labels, std::uint8_t region, const RegionBox& box,
                                      const std::array<double, 3>& sigma_voxels);

/// Gaussian sigma, in voxels, that takes no sheet of one voxel: its smoothed indicator stays at 0.79.
inline constexpr double fine_sigma_voxels = 0.4;

}  // namespace palpate::meshing
