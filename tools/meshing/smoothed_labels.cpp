// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/smoothed_labels.hpp"

#include <algorithm>
#include <cmath>

#include "tools/meshing/gaussian.hpp"

namespace palpate {

double smoothing_margin(const ImageGrid& grid, double sigma) {
    return gaussian_reach * sigma + 2 * grid.spacing.maxCoeff();
}

SmoothedLabels::SmoothedLabels(const RegionLabels& labels, double sigma)
    : grid_(labels.grid),
      region_count_(labels.values.size()),
      smoothed_(labels.grid.voxel_count() * labels.values.size()),
      offsets_(labels.values.size(), 0.0F),
      index_from_point_(labels.grid.spacing.cwiseInverse().asDiagonal() * labels.grid.direction.transpose()) {
    std::vector<std::int64_t> voxels(region_count_ + 1, 0);
    for (const std::uint8_t region : labels.regions) ++voxels[region];
    for (std::size_t region = 0; region < region_count_; ++region) add_scores(labels, region, sigma);
    // Neighbours push each other; three rounds bring the counts to within a few voxels.
    for (int round = 0; round < (region_count_ == 1 ? 1 : 3); ++round)
        for (std::size_t region = 0; region < region_count_; ++region)
            keep_voxel_count(region, voxels[region + 1]);
}

void SmoothedLabels::add_scores(const RegionLabels& labels, std::size_t region, double sigma) {
    // Only the box that the smoothed region reaches.
    std::array<std::int32_t, 3> low = grid_.size, high{-1, -1, -1};
    std::size_t offset = 0;
    for (std::int32_t k = 0; k < grid_.size[2]; ++k)
        for (std::int32_t j = 0; j < grid_.size[1]; ++j)
            for (std::int32_t i = 0; i < grid_.size[0]; ++i, ++offset)
                if (labels.regions[offset] == region + 1) {
                    low = {std::min(low[0], i), std::min(low[1], j), std::min(low[2], k)};
                    high = {std::max(high[0], i), std::max(high[1], j), std::max(high[2], k)};
                }
    FloatImage indicator;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double spacing = grid_.spacing[static_cast<Eigen::Index>(axis)];
        const auto reach = static_cast<std::int32_t>(std::ceil(gaussian_reach * sigma / spacing));
        low[axis] -= reach;
        indicator.size[axis] = high[axis] + reach + 1 - low[axis];
        indicator.sigma_voxels[axis] = sigma / spacing;
    }
    const auto row = static_cast<std::size_t>(indicator.size[0]);
    indicator.values.resize(row * static_cast<std::size_t>(indicator.size[1]) *
                            static_cast<std::size_t>(indicator.size[2]));
    const auto for_each_row = [&](auto&& visit) {
        float* values = indicator.values.data();
        for (std::int32_t k = 0; k < indicator.size[2]; ++k)
            for (std::int32_t j = 0; j < indicator.size[1]; ++j, values += row)
                visit(values, grid_.offset(low[0], low[1] + j, low[2] + k));
    };
    for_each_row([&](float* values, std::size_t voxel) {
        for (std::size_t i = 0; i < row; ++i)
            values[i] = labels.regions[voxel + i] == region + 1 ? 1.0F : 0.0F;
    });
    smooth(indicator);
    for_each_row([&](const float* values, std::size_t voxel) {
        for (std::size_t i = 0; i < row; ++i) smoothed_[(voxel + i) * region_count_ + region] = values[i];
    });
}

// The lead of a region at a voxel is its smoothed indicator less the best of the other scores. Exactly
// `voxels` voxels have a positive lead once the offset is minus the lead that ranks between them and the
// rest.
void SmoothedLabels::keep_voxel_count(std::size_t region, std::int64_t voxels) {
    std::vector<float> leads;
    for (std::size_t v = 0; v < smoothed_.size(); v += region_count_) {
        const float own = smoothed_[v + region];
        if (own == 0.0F) continue;
        float outside = 1.0F, best = -1.0F;
        for (std::size_t k = 0; k < region_count_; ++k) {
            outside -= smoothed_[v + k];
            if (k != region) best = std::max(best, smoothed_[v + k] + offsets_[k]);
        }
        leads.push_back(own - std::max(best, outside));
    }
    if (static_cast<std::size_t>(voxels) >= leads.size()) return;
    const auto rank = leads.begin() + static_cast<std::ptrdiff_t>(voxels);
    std::ranges::nth_element(leads, rank, std::greater<>());
    const float first_out = *rank;
    const float last_in = *std::min_element(leads.begin(), rank);
    offsets_[region] = -0.5F * (first_out + last_in);
}

std::uint8_t SmoothedLabels::region_at(const Eigen::Vector3d& p_P) const {
    const Eigen::Vector3d index = index_from_point_ * (p_P - grid_.origin);
    std::array<std::int32_t, 3> base{};
    std::array<float, 3> high{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double at = index[static_cast<Eigen::Index>(axis)];
        if (!(at >= 0 && at < grid_.size[axis] - 1)) return 0;
        base[axis] = static_cast<std::int32_t>(at);
        high[axis] = static_cast<float>(at - base[axis]);
    }
    const std::size_t step_j = static_cast<std::size_t>(grid_.size[0]) * region_count_;
    const std::size_t step_k = step_j * static_cast<std::size_t>(grid_.size[1]);
    const float* corner = smoothed_.data() + grid_.offset(base[0], base[1], base[2]) * region_count_;
    const auto along_i = [&](const float* value) {
        return value[0] + high[0] * (value[region_count_] - value[0]);
    };
    const auto along_j = [&](const float* value) {
        const float low = along_i(value);
        return low + high[1] * (along_i(value + step_j) - low);
    };
    std::uint8_t winner = 0;
    float best = -1.0F, outside = 1.0F;
    for (std::size_t k = 0; k < region_count_; ++k, ++corner) {
        const float low = along_j(corner);
        const float smoothed = low + high[2] * (along_j(corner + step_k) - low);
        outside -= smoothed;
        if (smoothed + offsets_[k] > best) {
            best = smoothed + offsets_[k];
            winner = static_cast<std::uint8_t>(k + 1);
        }
    }
    return best > outside ? winner : std::uint8_t{0};
}

}  // namespace palpate
