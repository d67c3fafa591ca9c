// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "tools/meshing/region_labels.hpp"

namespace palpate {

/// Region labels without stairs: the label at a point is the one with the highest score, where a region's
/// score is its indicator smoothed by a Gaussian, interpolated linearly, plus an offset of its own that gives
/// the region as many voxels as it had before; the outside's score is one minus the smoothed indicators.
/// Without the offsets smoothing shrinks what is small and enclosed (by about 2 sigma² / r² of its volume).
class SmoothedLabels {
  public:
    /// `sigma` in mm; `labels` needs a margin of 3 sigma and two voxels (unchecked).
    /// Cost: O(voxels x regions x sigma / spacing).
    SmoothedLabels(const RegionLabels& labels, double sigma);

    /// Returns the region at p_P: 0 outside the body, k for the k-th. Thread-safe.
    std::uint8_t region_at(const Eigen::Vector3d& p_P) const;

    const ImageGrid& grid() const { return grid_; }
    std::size_t region_count() const { return region_count_; }

  private:
    void add_scores(const RegionLabels& labels, std::size_t region, double sigma);
    void keep_voxel_count(std::size_t region, std::int64_t voxels);

    ImageGrid grid_;
    std::size_t region_count_;
    std::vector<float> smoothed_;  // region fastest
    std::vector<float> offsets_;
    Eigen::Matrix3d index_from_point_;
};

/// The margin in mm that SmoothedLabels needs around its regions.
double smoothing_margin(const ImageGrid& grid, double sigma);

}  // namespace palpate
