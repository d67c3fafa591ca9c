// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/voxels/label_statistics.hpp"

#include <algorithm>

#include "tools/imaging/voxels/mask.hpp"

namespace palpate::imaging {

std::vector<LabelStatistics> label_statistics(const LabelMap& map) {
    std::vector<LabelStatistics> all;
    for (const Label& label : map.names) {
        LabelStatistics statistics;
        statistics.label = label;
        Mask mask{map.grid, std::vector<std::uint8_t>(map.labels.size())};
        std::size_t offset = 0;
        for (std::int32_t k = 0; k < map.grid.size[2]; ++k)
            for (std::int32_t j = 0; j < map.grid.size[1]; ++j)
                for (std::int32_t i = 0; i < map.grid.size[0]; ++i, ++offset) {
                    if (map.labels[offset] != label.value) continue;
                    mask.voxels[offset] = 1;
                    const Eigen::Vector3d p_P = map.grid.point_of(Eigen::Vector3d(i, j, k));
                    statistics.box.extend(p_P);
                    statistics.centroid += p_P;
                    ++statistics.voxels;
                }
        if (statistics.voxels > 0) statistics.centroid /= static_cast<double>(statistics.voxels);
        statistics.volume_ml = static_cast<double>(statistics.voxels) * map.grid.voxel_volume() / 1000;
        statistics.components = components_of(mask).sizes.size();
        all.push_back(std::move(statistics));
    }
    return all;
}

}  // namespace palpate::imaging
