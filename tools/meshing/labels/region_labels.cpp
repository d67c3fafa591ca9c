// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/labels/region_labels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "formats/model/disjoint_sets.hpp"
#include "formats/model/errors.hpp"

namespace palpate::meshing {
namespace {

struct VoxelRange {
    std::array<std::int32_t, 3> low, high;  // inclusive
};

// Maps every label value to its region number, 0 for all others.
std::vector<std::uint8_t> region_table(std::span<const std::int32_t> values) {
    std::vector<std::uint8_t> table(65536, 0);
    for (std::size_t k = 0; k < values.size(); ++k) table[values[k]] = static_cast<std::uint8_t>(k + 1);
    return table;
}

VoxelRange bounding_box(const LabelMap& map, const std::vector<std::uint8_t>& table,
                        std::span<const std::int32_t> values) {
    VoxelRange box{map.grid.size, {-1, -1, -1}};
    std::vector<bool> seen(256, false);
    std::size_t offset = 0;
    for (std::int32_t k = 0; k < map.grid.size[2]; ++k)
        for (std::int32_t j = 0; j < map.grid.size[1]; ++j)
            for (std::int32_t i = 0; i < map.grid.size[0]; ++i, ++offset) {
                const std::uint8_t region = table[map.labels[offset]];
                if (region == 0) continue;
                seen[region] = true;
                const std::array<std::int32_t, 3> index{i, j, k};
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    box.low[axis] = std::min(box.low[axis], index[axis]);
                    box.high[axis] = std::max(box.high[axis], index[axis]);
                }
            }
    for (std::size_t k = 0; k < values.size(); ++k)
        if (!seen[k + 1])
            throw InvalidInput({"label map", "label " + std::to_string(values[k]) + " has no voxel",
                                "1 or more", "segment it first, or leave it out"});
    return box;
}

// Equal voxels along i.
struct Run {
    std::size_t begin;
    std::int32_t length, first;  // `first` is the index i of its first voxel
    std::uint8_t region;
};

// All runs of a grid, row after row.
struct Runs {
    std::vector<Run> runs;
    std::vector<std::size_t> row_start;  // one more than there are rows
};

Runs find_runs(const RegionLabels& labels) {
    const auto nx = static_cast<std::size_t>(labels.grid.size[0]);
    Runs result;
    for (std::size_t row = 0; row < labels.regions.size(); row += nx) {
        result.row_start.push_back(result.runs.size());
        for (std::size_t i = 0; i < nx;) {
            const std::uint8_t region = labels.regions[row + i];
            std::size_t end = i + 1;
            while (end < nx && labels.regions[row + end] == region) ++end;
            result.runs.push_back(
                {row + i, static_cast<std::int32_t>(end - i), static_cast<std::int32_t>(i), region});
            i = end;
        }
    }
    result.row_start.push_back(result.runs.size());
    return result;
}

// Joins the runs of two rows that overlap and are of one region.
void join_rows(const Runs& all, std::size_t row_a, std::size_t row_b, DisjointSets& components) {
    std::size_t a = all.row_start[row_a], b = all.row_start[row_b];
    while (a < all.row_start[row_a + 1] && b < all.row_start[row_b + 1]) {
        if (all.runs[a].region == all.runs[b].region) components.join(a, b);
        const std::int32_t end_a = all.runs[a].first + all.runs[a].length;
        const std::int32_t end_b = all.runs[b].first + all.runs[b].length;
        if (end_a <= end_b) ++a;
        if (end_b <= end_a) ++b;
    }
}

}  // namespace

RegionLabels cut_out_regions(const LabelMap& map, std::span<const std::int32_t> values, double margin) {
    RegionLabels result;
    result.values.assign(values.begin(), values.end());
    std::ranges::sort(result.values);
    const bool twice = std::ranges::adjacent_find(result.values) != result.values.end();
    if (values.empty() || values.size() > 255 || twice || result.values.front() < 1 ||
        result.values.back() > 65535)
        throw InvalidInput(
            {"regions", twice ? "one is named twice" : std::to_string(values.size()) + " named",
             "1 ... 255 different label values from 1 to 65535", "name every label of the body once"});
    const std::vector<std::uint8_t> table = region_table(result.values);
    const VoxelRange box = bounding_box(map, table, result.values);

    std::array<std::int32_t, 3> first{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto pad =
            static_cast<std::int32_t>(std::ceil(margin / map.grid.spacing[static_cast<Eigen::Index>(axis)]));
        first[axis] = box.low[axis] - pad;
        result.grid.size[axis] = box.high[axis] - box.low[axis] + 1 + 2 * pad;
    }
    result.grid.spacing = map.grid.spacing;
    result.grid.direction = map.grid.direction;
    result.grid.origin = map.grid.point_of(Eigen::Vector3d(first[0], first[1], first[2]));
    result.regions.assign(result.grid.voxel_count(), 0);
    for (std::int32_t k = box.low[2]; k <= box.high[2]; ++k)
        for (std::int32_t j = box.low[1]; j <= box.high[1]; ++j) {
            const std::uint16_t* from = map.labels.data() + map.grid.offset(box.low[0], j, k);
            std::uint8_t* to =
                result.regions.data() + result.grid.offset(box.low[0] - first[0], j - first[1], k - first[2]);
            for (std::int32_t i = 0; i <= box.high[0] - box.low[0]; ++i) to[i] = table[from[i]];
        }
    return result;
}

LabelComponents find_components(const RegionLabels& labels) {
    const Runs all = find_runs(labels);
    const auto nx = static_cast<std::size_t>(labels.grid.size[0]);
    const auto ny = static_cast<std::size_t>(labels.grid.size[1]);
    DisjointSets joined(all.runs.size());
    for (std::size_t row = 0; row + 1 < all.row_start.size(); ++row) {
        if (row % ny > 0) join_rows(all, row - 1, row, joined);
        if (row >= ny) join_rows(all, row - ny, row, joined);
    }
    LabelComponents result;
    result.component_of.resize(labels.regions.size());
    std::vector<std::int32_t> number(all.runs.size(), -1);
    std::vector<Eigen::Vector3d> index_sums;
    for (std::size_t r = 0; r < all.runs.size(); ++r) {
        const Run& run = all.runs[r];
        std::int32_t& id = number[joined.root(r)];
        if (id < 0) {
            id = static_cast<std::int32_t>(result.components.size());
            result.components.push_back({.region = run.region});
            index_sums.push_back(Eigen::Vector3d::Zero());
        }
        const std::size_t row = run.begin / nx, y = row % ny, z = row / ny;
        index_sums[id] += run.length * Eigen::Vector3d(run.first + 0.5 * (run.length - 1),
                                                       static_cast<double>(y), static_cast<double>(z));
        result.components[id].voxels += run.length;
        std::fill_n(result.component_of.begin() + static_cast<std::ptrdiff_t>(run.begin), run.length, id);
    }
    for (std::size_t c = 0; c < result.components.size(); ++c)
        result.components[c].centroid =
            labels.grid.point_of(index_sums[c] / static_cast<double>(result.components[c].voxels));
    return result;
}

std::int64_t absorb_specks(RegionLabels& labels, double min_volume) {
    const std::array<std::ptrdiff_t, 3> stride{
        1, labels.grid.size[0], static_cast<std::ptrdiff_t>(labels.grid.size[0]) * labels.grid.size[1]};
    std::int64_t absorbed = 0;
    // A speck inside a speck waits for the next pass.
    for (bool again = true; again;) {
        again = false;
        const LabelComponents found = find_components(labels);
        const auto is_speck = [&](std::int32_t id) {
            return static_cast<double>(found.components[id].voxels) * labels.grid.voxel_volume() < min_volume;
        };
        // faces[component][region]; the margin keeps specks off the grid's border.
        std::vector<std::vector<std::int64_t>> faces(found.components.size());
        for (std::size_t v = 0; v < labels.regions.size(); ++v) {
            const std::int32_t id = found.component_of[v];
            if (!is_speck(id)) continue;
            auto& count = faces[id];
            count.resize(labels.values.size() + 1);
            for (const std::ptrdiff_t step : stride)
                for (const std::ptrdiff_t neighbour :
                     {static_cast<std::ptrdiff_t>(v) - step, static_cast<std::ptrdiff_t>(v) + step}) {
                    const std::int32_t other = found.component_of[neighbour];
                    if (other != id && !is_speck(other)) ++count[labels.regions[neighbour]];
                }
        }
        for (std::size_t v = 0; v < labels.regions.size(); ++v) {
            const auto& count = faces[found.component_of[v]];
            const auto most = std::ranges::max_element(count);
            if (most == count.end() || *most == 0) continue;
            labels.regions[v] = static_cast<std::uint8_t>(most - count.begin());
            again = true;
        }
        if (again)
            absorbed += std::ranges::count_if(faces, [](const auto& count) {
                return std::ranges::any_of(count, [](std::int64_t n) { return n > 0; });
            });
    }
    return absorbed;
}

}  // namespace palpate::meshing
