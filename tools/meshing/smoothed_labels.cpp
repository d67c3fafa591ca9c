// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/smoothed_labels.hpp"

#include <algorithm>
#include <cmath>

#include "tools/meshing/gaussian.hpp"

namespace palpate {
namespace {

using Index3 = std::array<std::int32_t, 3>;

constexpr std::int32_t block_edge = 8;     // voxels
constexpr double fine_sigma_voxels = 0.4;  // gives a sheet of one voxel a score of 0.79
constexpr double min_agreement = 0.985;    // leaves the mesh some room below a Dice of 0.98
constexpr double faces_per_area = 1.5;     // of voxels along a surface, averaged over its directions
constexpr float certain = 0.999F;          // a score that no other region comes near

struct IndexBox {
    Index3 low{}, size{};
};

template <typename Visit>  // visit(voxel, offset in the box)
void for_each_voxel(const Index3& low, const Index3& size, Visit&& visit) {
    std::size_t offset = 0;
    for (std::int32_t k = low[2]; k < low[2] + size[2]; ++k)
        for (std::int32_t j = low[1]; j < low[1] + size[1]; ++j)
            for (std::int32_t i = low[0]; i < low[0] + size[0]; ++i) visit(Index3{i, j, k}, offset++);
}

// The box of every region, and `reach` voxels more on each side.
std::vector<IndexBox> region_boxes(const RegionLabels& labels, const Index3& reach) {
    std::vector<Index3> low(labels.values.size(), labels.grid.size);
    std::vector<Index3> high(labels.values.size(), Index3{-1, -1, -1});
    for_each_voxel({}, labels.grid.size, [&](const Index3& voxel, std::size_t offset) {
        if (labels.regions[offset] == 0) return;
        const std::size_t region = labels.regions[offset] - 1U;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            low[region][axis] = std::min(low[region][axis], voxel[axis]);
            high[region][axis] = std::max(high[region][axis], voxel[axis]);
        }
    });
    std::vector<IndexBox> boxes(low.size());
    for (std::size_t region = 0; region < boxes.size(); ++region)
        for (std::size_t axis = 0; axis < 3; ++axis) {
            boxes[region].low[axis] = low[region][axis] - reach[axis];
            boxes[region].size[axis] = high[region][axis] - low[region][axis] + 1 + 2 * reach[axis];
        }
    return boxes;
}

std::vector<float> smoothed_indicator(const RegionLabels& labels, std::size_t region, const IndexBox& box,
                                      const std::array<double, 3>& sigma_voxels) {
    FloatImage image{box.size, sigma_voxels, {}};
    image.values.reserve(static_cast<std::size_t>(box.size[0]) * static_cast<std::size_t>(box.size[1]) *
                         static_cast<std::size_t>(box.size[2]));
    for_each_voxel(box.low, box.size, [&](const Index3& v, std::size_t) {
        image.values.push_back(labels.regions[labels.grid.offset(v[0], v[1], v[2])] == region + 1 ? 1.0F
                                                                                                  : 0.0F);
    });
    smooth(image);
    return std::move(image.values);
}

// The share of a region's voxels that keep their label when as many voxels as it has do.
double agreement(const RegionLabels& labels, std::size_t region, const IndexBox& box,
                 const std::vector<float>& smoothed) {
    std::vector<float> own, ranked = smoothed;
    for_each_voxel(box.low, box.size, [&](const Index3& v, std::size_t offset) {
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
                                             const IndexBox& box, double& sigma) {
    for (;; sigma *= 0.8) {
        std::array<double, 3> sigma_voxels{};
        for (std::size_t axis = 0; axis < 3; ++axis)
            sigma_voxels[axis] = sigma / labels.grid.spacing[static_cast<Eigen::Index>(axis)];
        std::vector<float> smoothed = smoothed_indicator(labels, region, box, sigma_voxels);
        if (std::ranges::max(sigma_voxels) <= fine_sigma_voxels ||
            agreement(labels, region, box, smoothed) >= min_agreement)
            return smoothed;
    }
}

// Reads an image with one value per block, linearly between their centres.
float at_voxel(const FloatImage& blocks, const Index3& voxel, const Index3& low) {
    std::array<std::size_t, 3> base{}, step{1, static_cast<std::size_t>(blocks.size[0]), 0};
    step[2] = step[1] * static_cast<std::size_t>(blocks.size[1]);
    std::array<float, 3> high{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const float at = std::clamp((static_cast<float>(voxel[axis] - low[axis]) + 0.5F) / block_edge - 0.5F,
                                    0.0F, static_cast<float>(blocks.size[axis] - 1));
        base[axis] = std::min(static_cast<std::size_t>(at),
                              static_cast<std::size_t>(std::max(0, blocks.size[axis] - 2)));
        high[axis] = at - static_cast<float>(base[axis]);
        if (blocks.size[axis] == 1) step[axis] = 0;
    }
    float sum = 0;
    const float* corner =
        blocks.values.data() + base[0] + base[1] * static_cast<std::size_t>(blocks.size[0]) +
        base[2] * static_cast<std::size_t>(blocks.size[0]) * static_cast<std::size_t>(blocks.size[1]);
    for (std::size_t c = 0; c < 8; ++c) {
        float weight = 1;
        std::size_t offset = 0;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const bool up = (c >> axis & 1U) != 0;
            weight *= up ? high[axis] : 1 - high[axis];
            offset += up ? step[axis] : 0;
        }
        sum += weight * corner[offset];
    }
    return sum;
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
    const std::vector<IndexBox> boxes = region_boxes(labels, reach);
    for (std::size_t region = 0; region < boxes.size(); ++region) {
        double own_sigma = sigma;
        std::vector<float> values = gently_smoothed_indicator(labels, region, boxes[region], own_sigma);
        scores_.push_back({boxes[region].low, boxes[region].size, own_sigma, std::move(values)});
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

void SmoothedLabels::protect_thin_parts(const RegionLabels& labels) {
    const std::vector<float> thin = thinness(labels);
    if (thin.empty()) return;
    for (std::size_t region = 0; region < region_count(); ++region) {
        Score& score = scores_[region];
        const std::vector<float> fine =
            smoothed_indicator(labels, region, {score.low, score.size},
                               {fine_sigma_voxels, fine_sigma_voxels, fine_sigma_voxels});
        for_each_voxel(score.low, score.size, [&](const Index3& v, std::size_t offset) {
            const float weight = thin[grid_.offset(v[0], v[1], v[2])];
            score.values[offset] += weight * (fine[offset] - score.values[offset]);
        });
    }
}

float SmoothedLabels::Score::at(const Index3& voxel) const {
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (voxel[axis] < low[axis] || voxel[axis] >= low[axis] + size[axis]) return 0;
    return values[(static_cast<std::size_t>(voxel[2] - low[2]) * static_cast<std::size_t>(size[1]) +
                   static_cast<std::size_t>(voxel[1] - low[1])) *
                      static_cast<std::size_t>(size[0]) +
                  static_cast<std::size_t>(voxel[0] - low[0])];
}

// A block lists the regions that score at one of its voxels or at a next one, which interpolation reads too.
void SmoothedLabels::list_candidates() {
    for (std::size_t axis = 0; axis < 3; ++axis) blocks_[axis] = (grid_.size[axis] - 1) / block_edge + 1;
    const std::size_t count = static_cast<std::size_t>(blocks_[0]) * static_cast<std::size_t>(blocks_[1]) *
                              static_cast<std::size_t>(blocks_[2]);
    std::vector<std::vector<std::uint8_t>> regions(count);
    for (std::size_t region = 0; region < region_count(); ++region) {
        const Score& score = scores_[region];
        for_each_voxel(score.low, score.size, [&](const Index3& v, std::size_t offset) {
            if (score.values[offset] == 0) return;
            for (std::int32_t k = std::max(0, v[2] - 1) / block_edge; k <= v[2] / block_edge; ++k)
                for (std::int32_t j = std::max(0, v[1] - 1) / block_edge; j <= v[1] / block_edge; ++j)
                    for (std::int32_t i = std::max(0, v[0] - 1) / block_edge; i <= v[0] / block_edge; ++i) {
                        auto& list = regions[static_cast<std::size_t>((k * blocks_[1] + j) * blocks_[0] + i)];
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
    const auto block = static_cast<std::size_t>(
        (voxel[2] / block_edge * blocks_[1] + voxel[1] / block_edge) * blocks_[0] + voxel[0] / block_edge);
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

// Exactly `voxels` voxels have a positive lead once the offset is minus the lead that ranks between them and
// the rest. Neighbours push each other; three rounds bring the counts to within a few voxels.
void SmoothedLabels::keep_voxel_counts(const std::vector<std::int64_t>& voxels) {
    for (int round = 0; round < (region_count() == 1 ? 1 : 3); ++round)
        for (std::size_t region = 0; region < region_count(); ++region) {
            const Score& score = scores_[region];
            std::int64_t wanted = voxels[region + 1];
            std::vector<float> leads;
            for_each_voxel(score.low, score.size, [&](const Index3& voxel, std::size_t offset) {
                const float own = score.values[offset];
                if (own == 0) return;
                if (own >= certain) {
                    --wanted;
                    return;
                }
                leads.push_back(lead(region, voxel, own));
            });
            if (wanted <= 0 || static_cast<std::size_t>(wanted) >= leads.size()) continue;
            const auto rank = leads.begin() + wanted;
            std::ranges::nth_element(leads, rank, std::greater<>());
            scores_[region].offset = -0.5F * (*rank + *std::min_element(leads.begin(), rank));
        }
}

std::vector<std::uint8_t> SmoothedLabels::winners_at_voxels() const {
    std::vector<std::uint8_t> winners(grid_.voxel_count(), 0);
    for_each_voxel({}, grid_.size, [&](const Index3& voxel, std::size_t offset) {
        if (!candidates_at(voxel).empty()) winners[offset] = winner_at(voxel);
    });
    return winners;
}

// Smoothing takes from what is thin and pointed, and a region's one offset gives it back to all of its
// surface: its centroid moves. So scores rise and fall from block to block as far as the surface must move to
// keep the number of voxels around there.
void SmoothedLabels::keep_volumes_locally(const RegionLabels& labels) {
    const std::vector<std::uint8_t> winners = winners_at_voxels();
    const std::array<std::size_t, 3> stride{1, static_cast<std::size_t>(grid_.size[0]),
                                            grid_.offset(0, 0, 1)};
    for (std::size_t region = 0; region < region_count(); ++region) {
        Score& score = scores_[region];
        FloatImage missing{{}, {1, 1, 1}, {}};  // mm³ per block
        for (std::size_t axis = 0; axis < 3; ++axis)
            missing.size[axis] = (score.size[axis] - 1) / block_edge + 1;
        missing.values.resize(static_cast<std::size_t>(missing.size[0]) *
                              static_cast<std::size_t>(missing.size[1]) *
                              static_cast<std::size_t>(missing.size[2]));
        FloatImage area = missing;  // mm² per block
        for_each_voxel(score.low, score.size, [&](const Index3& v, std::size_t) {
            const std::size_t voxel = grid_.offset(v[0], v[1], v[2]);
            const bool labelled = labels.regions[voxel] == region + 1, won = winners[voxel] == region + 1;
            const auto block = static_cast<std::size_t>(
                ((v[2] - score.low[2]) / block_edge * missing.size[1] + (v[1] - score.low[1]) / block_edge) *
                    missing.size[0] +
                (v[0] - score.low[0]) / block_edge);
            const auto volume = static_cast<float>(grid_.voxel_volume());
            if (labelled != won) missing.values[block] += labelled ? volume : -volume;
            if (!won) return;
            for (std::size_t axis = 0; axis < 3; ++axis)
                for (const std::size_t next : {voxel - stride[axis], voxel + stride[axis]})
                    if (winners[next] != region + 1)
                        area.values[block] += static_cast<float>(
                            grid_.voxel_volume() / grid_.spacing[static_cast<Eigen::Index>(axis)] /
                            faces_per_area);
        });
        smooth(missing);
        smooth(area);
        const auto change_per_mm = static_cast<float>(0.4 / score.sigma);  // across a flat surface
        for (std::size_t block = 0; block < area.values.size(); ++block)
            missing.values[block] =
                area.values[block] > 0
                    ? std::clamp(change_per_mm * missing.values[block] / area.values[block], -0.25F, 0.25F)
                    : 0.0F;
        for_each_voxel(score.low, score.size, [&](const Index3& v, std::size_t offset) {
            float& value = score.values[offset];
            // 1 on the surface, 0 far from it.
            const float nearness = 4 * value * (1 - value);
            if (nearness > 0) value += nearness * at_voxel(missing, v, score.low);
        });
    }
}

// From 0 where smoothing keeps the labels, up to a voxel, to 1 where it loses a sheet; empty if that is
// nowhere.
std::vector<float> SmoothedLabels::thinness(const RegionLabels& labels) const {
    const std::vector<std::uint8_t> winners = winners_at_voxels();
    FloatImage lost{grid_.size, {1, 1, 1}, std::vector<float>(grid_.voxel_count(), 0)};
    const std::array<std::size_t, 3> stride{1, static_cast<std::size_t>(grid_.size[0]),
                                            grid_.offset(0, 0, 1)};
    bool any = false;
    for_each_voxel({}, grid_.size, [&](const Index3&, std::size_t offset) {
        const std::uint8_t label = labels.regions[offset];
        if (winners[offset] == label) return;  // as it is along the border, which is outside
        for (const std::size_t step : stride)
            if (winners[offset - step] == label || winners[offset + step] == label) return;
        lost.values[offset] = 1;
        any = true;
    });
    if (!any) return {};
    smooth(lost);
    // Voxels in a sheet smooth to 0.4, in a line to 0.16, lone ones to 0.06.
    for (float& value : lost.values) value = std::min(1.0F, 5 * value);
    return std::move(lost.values);
}

Volume SmoothedLabels::leads(std::uint8_t region) const {
    const Score& score = scores_[region - 1U];
    Volume volume{grid_, {}};
    volume.grid.size = score.size;
    volume.grid.origin = grid_.point_of(Eigen::Vector3d(score.low[0], score.low[1], score.low[2]));
    volume.values.reserve(score.values.size());
    for_each_voxel(score.low, score.size, [&](const Index3& voxel, std::size_t offset) {
        volume.values.push_back(lead(region - 1U, voxel, score.values[offset]) + score.offset);
    });
    return volume;
}

std::uint8_t SmoothedLabels::winner_at(const Index3& voxel) const {
    std::uint8_t winner = 0;
    float best = -1.0F, outside = 1.0F;
    for (const std::uint8_t region : candidates_at(voxel)) {
        const float smoothed = scores_[region].at(voxel);
        outside -= smoothed;
        if (smoothed + scores_[region].offset > best) {
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
            from[axis] = base[axis] - score.low[axis];
            inside &= from[axis] >= 0 && from[axis] + 1 < score.size[axis];
        }
        if (!inside) continue;
        const std::ptrdiff_t step_j = score.size[0], step_k = step_j * score.size[1];
        const float* corner = score.values.data() + from[2] * step_k + from[1] * step_j + from[0];
        const auto along_i = [&](const float* value) { return value[0] + high[0] * (value[1] - value[0]); };
        const auto along_j = [&](const float* value) {
            const float low = along_i(value);
            return low + high[1] * (along_i(value + step_j) - low);
        };
        const float low = along_j(corner);
        const float smoothed = low + high[2] * (along_j(corner + step_k) - low);
        outside -= smoothed;
        if (smoothed + score.offset > best) {
            best = smoothed + score.offset;
            winner = static_cast<std::uint8_t>(region + 1);
        }
    }
    return best > outside ? winner : std::uint8_t{0};
}

}  // namespace palpate
