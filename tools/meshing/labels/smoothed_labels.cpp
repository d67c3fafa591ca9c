// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/labels/smoothed_labels.hpp"

#include <algorithm>
#include <cmath>

#include "tools/meshing/labels/gaussian.hpp"

namespace palpate::meshing {
namespace {

constexpr float eligible = 0.2F;         // below, a region is too far away to win where others are level
constexpr double min_agreement = 0.985;  // leaves the mesh some room below a Dice of 0.98

// The share of a region's voxels that keep their label when as many voxels as it has do.
double agreement(const RegionLabels& labels, std::size_t region, const RegionBox& box,
                 const std::vector<float>& smoothed) {
    std::vector<float> own, ranked = smoothed;
    for_each_voxel(box, [&](const Index3& v, std::size_t offset) {
        if (labels.regions[labels.grid.offset(v[0], v[1], v[2])] == region + 1)
            own.push_back(smoothed[offset]);
    });
    std::ranges::nth_element(ranked, ranked.begin() + static_cast<std::ptrdiff_t>(own.size()) - 1,
                             std::greater<>());
    const float level = ranked[own.size() - 1];
    return static_cast<double>(std::ranges::count_if(own, [&](float value) { return value >= level; })) /
           static_cast<double>(own.size());
}

// The indicator smoothed by `sigma` mm or, if the region would lose its shape, by as much as it bears;
// `sigma` is then that.
std::vector<float> gently_smoothed_indicator(const RegionLabels& labels, std::size_t region,
                                             const RegionBox& box, double& sigma) {
    for (;; sigma *= 0.8) {
        std::array<double, 3> sigma_voxels{};
        for (std::size_t axis = 0; axis < 3; ++axis)
            sigma_voxels[axis] = sigma / labels.grid.spacing[static_cast<Eigen::Index>(axis)];
        std::vector<float> smoothed =
            smoothed_indicator(labels, static_cast<std::uint8_t>(region + 1), box, sigma_voxels);
        if (std::ranges::max(sigma_voxels) <= fine_sigma_voxels ||
            agreement(labels, region, box, smoothed) >= min_agreement)
            return smoothed;
    }
}

}  // namespace

double smoothing_margin(const ImageGrid& grid, double sigma) {
    return gaussian_reach * sigma + 2 * grid.spacing.maxCoeff();
}

SmoothedLabels::SmoothedLabels(const RegionLabels& labels, double sigma)
    : grid_(labels.grid),
      index_from_point_(labels.grid.spacing.cwiseInverse().asDiagonal() * labels.grid.direction.transpose()) {
    Index3 reach{};
    for (std::size_t axis = 0; axis < 3; ++axis)
        reach[axis] =
            std::max(2, static_cast<std::int32_t>(std::ceil(gaussian_reach * sigma /
                                                            grid_.spacing[static_cast<Eigen::Index>(axis)])));
    const std::vector<RegionBox> boxes = region_boxes(labels, reach);
    for (std::size_t region = 0; region < boxes.size(); ++region) {
        double own_sigma = sigma;
        std::vector<float> values = gently_smoothed_indicator(labels, region, boxes[region], own_sigma);
        scores_.push_back({boxes[region], own_sigma, std::move(values)});
    }
    list_candidates();
    std::vector<std::int64_t> voxels(region_count() + 1, 0);
    for (const std::uint8_t region : labels.regions) ++voxels[region];
    keep_voxel_counts(voxels);

    protect_thin_parts(labels);
    for (int round = 0; round < 2; ++round) {
        keep_volumes_locally(labels);
        keep_voxel_counts(voxels);
    }
}

float SmoothedLabels::Score::at(const Index3& voxel) const {
    Index3 at{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        at[axis] = voxel[axis] - box.low[axis];
        if (at[axis] < 0 || at[axis] >= box.size[axis]) return 0;
    }
    const auto row = static_cast<std::size_t>(at[2]) * static_cast<std::size_t>(box.size[1]) +
                     static_cast<std::size_t>(at[1]);
    return values[row * static_cast<std::size_t>(box.size[0]) + static_cast<std::size_t>(at[0])];
}

// A block lists the regions that score at one of its voxels or at a next one, which interpolation reads too.
void SmoothedLabels::list_candidates() {
    for (std::size_t axis = 0; axis < 3; ++axis) blocks_[axis] = (grid_.size[axis] - 1) / block_edge + 1;
    const std::size_t count = static_cast<std::size_t>(blocks_[0]) * static_cast<std::size_t>(blocks_[1]) *
                              static_cast<std::size_t>(blocks_[2]);
    std::vector<std::vector<std::uint8_t>> regions(count);
    for (std::size_t region = 0; region < region_count(); ++region) {
        const Score& score = scores_[region];
        for_each_voxel(score.box, [&](const Index3& v, std::size_t offset) {
            if (score.values[offset] == 0) return;
            for (std::int32_t k = std::max(0, v[2] - 1) / block_edge; k <= v[2] / block_edge; ++k)
                for (std::int32_t j = std::max(0, v[1] - 1) / block_edge; j <= v[1] / block_edge; ++j)
                    for (std::int32_t i = std::max(0, v[0] - 1) / block_edge; i <= v[0] / block_edge; ++i) {
                        auto& list = regions[(k * blocks_[1] + j) * blocks_[0] + i];
                        if (list.empty() || list.back() != region)
                            list.push_back(static_cast<std::uint8_t>(region));
                    }
        });
    }
    candidates_start_.push_back(0);
    for (const auto& list : regions) {
        candidates_.insert(candidates_.end(), list.begin(), list.end());
        candidates_start_.push_back(static_cast<std::uint32_t>(candidates_.size()));
    }
}

std::span<const std::uint8_t> SmoothedLabels::candidates_at(const Index3& voxel) const {
    const std::int32_t block =
        (voxel[2] / block_edge * blocks_[1] + voxel[1] / block_edge) * blocks_[0] + voxel[0] / block_edge;
    return std::span(candidates_)
        .subspan(candidates_start_[block], candidates_start_[block + 1] - candidates_start_[block]);
}

// The smoothed indicator of a region at a voxel less the best of the other scores.
float SmoothedLabels::lead(std::size_t region, const Index3& voxel, float own) const {
    float outside = 1.0F, best = -1.0F;
    for (const std::uint8_t other : candidates_at(voxel)) {
        const float smoothed = scores_[other].at(voxel);
        outside -= smoothed;
        if (other != region) best = std::max(best, smoothed + scores_[other].offset);
    }
    return own - std::max(best, outside);
}

Volume SmoothedLabels::leads(std::uint8_t region) const {
    const Score& score = scores_[region - 1U];
    Volume volume{grid_, {}};
    volume.grid.size = score.box.size;
    volume.grid.origin =
        grid_.point_of(Eigen::Vector3d(score.box.low[0], score.box.low[1], score.box.low[2]));
    volume.values.reserve(score.values.size());
    for_each_voxel(score.box, [&](const Index3& voxel, std::size_t offset) {
        const float own = score.values[offset];
        volume.values.push_back(std::min(lead(region - 1U, voxel, own) + score.offset, own - eligible));
    });
    return volume;
}

std::uint8_t SmoothedLabels::winner_at(const Index3& voxel) const {
    std::uint8_t winner = 0;
    float best = -1.0F, outside = 1.0F;
    for (const std::uint8_t region : candidates_at(voxel)) {
        const float smoothed = scores_[region].at(voxel);
        outside -= smoothed;
        if (smoothed >= eligible && smoothed + scores_[region].offset > best) {
            best = smoothed + scores_[region].offset;
            winner = static_cast<std::uint8_t>(region + 1);
        }
    }
    return best > outside ? winner : std::uint8_t{0};
}

std::uint8_t SmoothedLabels::region_at(const Eigen::Vector3d& p_P) const {
    const Eigen::Vector3d index = index_from_point_ * (p_P - grid_.origin);
    Index3 base{};
    std::array<float, 3> high{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double at = index[static_cast<Eigen::Index>(axis)];
        if (!(at >= 0 && at < grid_.size[axis] - 1)) return 0;
        base[axis] = static_cast<std::int32_t>(at);
        high[axis] = static_cast<float>(at - base[axis]);
    }
    std::uint8_t winner = 0;
    float best = -1.0F, outside = 1.0F;
    for (const std::uint8_t region : candidates_at(base)) {
        const Score& score = scores_[region];
        Index3 from{};
        bool inside = true;  // the scores around the box are zero
        for (std::size_t axis = 0; axis < 3; ++axis) {
            from[axis] = base[axis] - score.box.low[axis];
            inside &= from[axis] >= 0 && from[axis] + 1 < score.box.size[axis];
        }
        if (!inside) continue;
        const std::ptrdiff_t step_j = score.box.size[0], step_k = step_j * score.box.size[1];
        const float* corner = score.values.data() + from[2] * step_k + from[1] * step_j + from[0];
        const auto along_i = [&](const float* value) { return value[0] + high[0] * (value[1] - value[0]); };
        const auto along_j = [&](const float* value) {
            const float low = along_i(value);
            return low + high[1] * (along_i(value + step_j) - low);
        };
        const float low = along_j(corner);
        const float smoothed = low + high[2] * (along_j(corner + step_k) - low);
        outside -= smoothed;
        if (smoothed >= eligible && smoothed + score.offset > best) {
            best = smoothed + score.offset;
            winner = static_cast<std::uint8_t>(region + 1);
        }
    }
    return best > outside ? winner : std::uint8_t{0};
}

}  // namespace palpate::meshing
