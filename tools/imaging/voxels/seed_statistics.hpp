// SPDX-License-Identifier: GPL-3.0-or-later
// What the grey values around seeds say about a structure.
#pragma once
#include <array>
#include <span>
#include <string>
#include <vector>

#include "formats/model/image_grid.hpp"
#include "tools/imaging/voxels/mask.hpp"

namespace palpate::imaging {

/// Middle and spread of grey values, insensitive to outliers.
struct GreyStatistics {
    double mean = 0;   ///< median
    double sigma = 0;  ///< 1.4826 times the median absolute deviation
};

/// Statistics of `values`, which are reordered; zeros if there are none.
GreyStatistics robust_statistics(std::vector<float>& values);

/// Values within `radius` (mm) of any of `points` (p_P), or of the voxel nearest to each if there are none.
std::vector<float> values_near(const Volume& volume, std::span<const Eigen::Vector3d> points, double radius);

/// Indices of the voxel that holds `p_P`; throws InvalidInput naming `culprit` (which says whose seed it is),
/// the point and the volume's extent if it lies outside.
std::array<std::int32_t, 3> voxel_of_seed(const ImageGrid& grid, const Eigen::Vector3d& p_P,
                                          const std::string& culprit);

constexpr double seed_miss_mm = 3;  ///< a seed may miss what it means by a voxel or two

/// The offset of the voxel of the mask nearest to each seed (p_P). Throws InvalidInput with `culprit`, the
/// seed, `expected` and `next_step` if none is within seed_miss_mm.
std::vector<std::size_t> voxels_at(const Mask& mask, std::span<const Eigen::Vector3d> seeds,
                                   const std::string& culprit, const std::string& expected,
                                   const std::string& next_step);

/// "(12, -3.5, 40) mm".
std::string point_text(const Eigen::Vector3d& p_P);

}  // namespace palpate::imaging
