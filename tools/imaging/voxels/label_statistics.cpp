// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/voxels/label_statistics.hpp"

#include <algorithm>
#include <iterator>

#include "tools/imaging/voxels/mask.hpp"

namespace palpate::imaging {
namespace {

constexpr std::size_t all_values = 65536;

// The voxels of each value, as boxes of indices.
std::vector<Eigen::AlignedBox3i> index_boxes(const LabelMap& map) {
    std::vector<Eigen::AlignedBox3i> boxes(all_values);
    std::size_t offset = 0;
    for (std::int32_t k = 0; k < map.grid.size[2]; ++k)
        for (std::int32_t j = 0; j < map.grid.size[1]; ++j)
            for (std::int32_t i = 0; i < map.grid.size[0]; ++i, ++offset)
                if (map.labels[offset] != 0) boxes[map.labels[offset]].extend(Eigen::Vector3i(i, j, k));
    return boxes;
}

bool at_edge(const Eigen::AlignedBox3i& box, const ImageGrid& grid) {
    const Eigen::Vector3i last = Eigen::Vector3i(grid.size.data()).array() - 1;
    return !box.isEmpty() && ((box.min().array() == 0).any() || (box.max().array() == last.array()).any());
}

}  // namespace

std::vector<Label> labels_at_image_edge(const LabelMap& map) {
    const std::vector<Eigen::AlignedBox3i> boxes = index_boxes(map);
    std::vector<Label> found;
    std::ranges::copy_if(map.names, std::back_inserter(found),
                         [&](const Label& label) { return at_edge(boxes[label.value], map.grid); });
    return found;
}

std::vector<LabelStatistics> label_statistics(const LabelMap& map) {
    const std::vector<Eigen::AlignedBox3i> boxes = index_boxes(map);
    std::vector<LabelStatistics> all;
    for (const Label& label : map.names) {
        LabelStatistics statistics;
        statistics.label = label;
        if (const Eigen::AlignedBox3i& box = boxes[label.value]; !box.isEmpty()) {
            Mask mask;  // of the box alone: pieces do not depend on where it lies
            Eigen::Map<Eigen::Vector3i>(mask.grid.size.data()) = box.sizes().array() + 1;
            for (std::int32_t k = box.min()[2]; k <= box.max()[2]; ++k)
                for (std::int32_t j = box.min()[1]; j <= box.max()[1]; ++j)
                    for (std::int32_t i = box.min()[0]; i <= box.max()[0]; ++i) {
                        mask.voxels.push_back(map.labels[map.grid.offset(i, j, k)] == label.value);
                        if (mask.voxels.back() == 0) continue;
                        const Eigen::Vector3d p_P = map.grid.point_of(Eigen::Vector3d(i, j, k));
                        statistics.box.extend(p_P);
                        statistics.centroid += p_P;
                        ++statistics.voxels;
                    }
            statistics.centroid /= static_cast<double>(statistics.voxels);
            statistics.components = components_of(mask).sizes.size();
            statistics.at_image_edge = at_edge(box, map.grid);
        }
        statistics.volume_ml = static_cast<double>(statistics.voxels) * map.grid.voxel_volume() / 1000;
        all.push_back(std::move(statistics));
    }
    return all;
}

}  // namespace palpate::imaging
