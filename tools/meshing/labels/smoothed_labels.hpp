// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "tools/meshing/labels/region_boxes.hpp"
#include "tools/meshing/labels/region_labels.hpp"

namespace palpate::meshing {

/// Region labels without stairs: the label at a point is the one with the highest score, where a region's
/// score is its indicator smoothed by a Gaussian, interpolated linearly, plus an offset of its own that gives
/// the region as many voxels as it had before; the outside's score is one minus the smoothed indicators.
/// Without the offsets smoothing shrinks what is small and enclosed (by about 2 sigma² / r² of its volume).
///
/// Thin parts are protected: where voxels that smoothing would give to another region lie close together, as
/// they do in a sheet or a tip but not along a rough surface, the Gaussian narrows to less than a voxel.
class SmoothedLabels {
  public:
    /// `sigma` in mm; `labels` needs a margin of smoothing_margin() (unchecked).
    /// Cost: O(voxels of the regions' boxes x sigma / spacing); 4 bytes for each such voxel are kept.
    SmoothedLabels(const RegionLabels& labels, double sigma);

    /// Returns the region at p_P: 0 outside the body, k for the k-th. Thread-safe.
    std::uint8_t region_at(const Eigen::Vector3d& p_P) const;

    /// Returns by how much a region's score is above the best of the others, at the voxels of the box that it
    /// reaches: positive inside the region.
    Volume leads(std::uint8_t region) const;

    const ImageGrid& grid() const { return grid_; }
    std::size_t region_count() const { return scores_.size(); }

  private:
    // A region's smoothed indicator in the box that it reaches; zero elsewhere.
    struct Score {
        RegionBox box;
        double sigma = 0;           // mm
        std::vector<float> values;  // i fastest
        float offset = 0;

        float at(const Index3& voxel) const;
    };

    void list_candidates();
    float lead(std::size_t region, const Index3& voxel, float own) const;
    void keep_voxel_counts(const std::vector<std::int64_t>& voxels);
    void protect_thin_parts(const RegionLabels& labels);
    void keep_volumes_locally(const RegionLabels& labels);
    std::vector<std::uint8_t> winners_at_voxels() const;
    std::vector<float> thinness(const RegionLabels& labels) const;
    std::span<const std::uint8_t> candidates_at(const Index3& voxel) const;
    std::uint8_t winner_at(const Index3& voxel) const;

    static constexpr std::int32_t block_edge = 8;  // voxels

    ImageGrid grid_;
    Eigen::Matrix3d index_from_point_;
    std::vector<Score> scores_;  // of regions 1, 2, ...
    // The regions with a score somewhere in each block of voxels: block b's are those from start b to b + 1.
    Index3 blocks_{};
    std::vector<std::uint32_t> candidates_start_;
    std::vector<std::uint8_t> candidates_;
};

/// The margin in mm that SmoothedLabels needs around its regions.
double smoothing_margin(const ImageGrid& grid, double sigma);

}  // namespace palpate::meshing
