// SPDX-License-Identifier: GPL-3.0-or-later
// How SmoothedLabels keep what smoothing takes: numbers of voxels, volumes around every place, thin parts.
#include <algorithm>
#include <cmath>

#include "tools/meshing/labels/gaussian.hpp"
#include "tools/meshing/labels/smoothed_labels.hpp"

namespace palpate::meshing {
namespace {

constexpr double faces_per_area = 1.5;  // of voxels along a surface, averaged over its directions
constexpr float certain = 0.999F;       // a score that no other region comes near

// Reads an image with one value per block, linearly between their centres.
float at_voxel(const FloatImage& blocks, std::int32_t block_edge, const Index3& voxel, const Index3& low) {
    std::array<std::size_t, 3> base{}, step{1, static_cast<std::size_t>(blocks.size[0]), 0};
    step[2] = step[1] * static_cast<std::size_t>(blocks.size[1]);
    std::array<float, 3> high{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const float at = std::clamp(
            (static_cast<float>(voxel[axis] - low[axis]) + 0.5F) / static_cast<float>(block_edge) - 0.5F,
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

// Exactly `voxels` voxels have a positive lead once the offset is minus the lead that ranks between them and
// the rest. Neighbours push each other; three rounds bring the counts to within a few voxels.
void SmoothedLabels::keep_voxel_counts(const std::vector<std::int64_t>& voxels) {
    for (int round = 0; round < (region_count() == 1 ? 1 : 3); ++round)
        for (std::size_t region = 0; region < region_count(); ++region) {
            const Score& score = scores_[region];
            std::int64_t wanted = voxels[region + 1];
            std::vector<float> leads;
            for_each_voxel(score.box, [&](const Index3& voxel, std::size_t offset) {
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
    for_each_voxel({{}, grid_.size}, [&](const Index3& voxel, std::size_t offset) {
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
        if (score.sigma == 0) continue;
        FloatImage missing{{}, {1, 1, 1}, {}};  // mm³ per block
        for (std::size_t axis = 0; axis < 3; ++axis)
            missing.size[axis] = (score.box.size[axis] - 1) / block_edge + 1;
        missing.values.resize(static_cast<std::size_t>(missing.size[0]) *
                              static_cast<std::size_t>(missing.size[1]) *
                              static_cast<std::size_t>(missing.size[2]));
        FloatImage area = missing;  // mm² per block
        for_each_voxel(score.box, [&](const Index3& v, std::size_t) {
            const std::size_t voxel = grid_.offset(v[0], v[1], v[2]);
            const bool labelled = labels.regions[voxel] == region + 1, won = winners[voxel] == region + 1;
            const std::int32_t block = ((v[2] - score.box.low[2]) / block_edge * missing.size[1] +
                                        (v[1] - score.box.low[1]) / block_edge) *
                                           missing.size[0] +
                                       (v[0] - score.box.low[0]) / block_edge;
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
        for_each_voxel(score.box, [&](const Index3& v, std::size_t offset) {
            float& value = score.values[offset];
            // 1 on the surface, 0 far from it.
            const float nearness = 4 * value * (1 - value);
            if (nearness > 0) value += nearness * at_voxel(missing, block_edge, v, score.box.low);
        });
    }
}

void SmoothedLabels::protect_thin_parts(const RegionLabels& labels) {
    const std::vector<float> thin = thinness(labels);
    if (thin.empty()) return;
    for (std::size_t region = 0; region < region_count(); ++region) {
        Score& score = scores_[region];
        const std::vector<float> fine =
            smoothed_indicator(labels, static_cast<std::uint8_t>(region + 1), score.box,
                               {fine_sigma_voxels, fine_sigma_voxels, fine_sigma_voxels});
        for_each_voxel(score.box, [&](const Index3& v, std::size_t offset) {
            const float weight = thin[grid_.offset(v[0], v[1], v[2])];
            score.values[offset] += weight * (fine[offset] - score.values[offset]);
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
    for_each_voxel({{}, grid_.size}, [&](const Index3&, std::size_t offset) {
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

}  // namespace palpate::meshing
