// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace palpate {

/// Where voxels lie in the patient frame P (LPS, mm). The centre of voxel (i, j, k) is
/// p_P = origin + direction * diag(spacing) * (i, j, k); index i runs fastest in memory.
struct ImageGrid {
    std::array<std::int32_t, 3> size{0, 0, 0};                ///< voxels along i, j, k
    Eigen::Vector3d spacing = Eigen::Vector3d::Ones();        ///< mm
    Eigen::Vector3d origin = Eigen::Vector3d::Zero();         ///< p_P of the centre of voxel (0, 0, 0)
    Eigen::Matrix3d direction = Eigen::Matrix3d::Identity();  ///< columns: unit directions of i, j, k in P

    std::size_t voxel_count() const;
    double voxel_volume() const;  ///< mm³
    std::size_t offset(std::int32_t i, std::int32_t j, std::int32_t k) const {
        return (static_cast<std::size_t>(k) * static_cast<std::size_t>(size[1]) +
                static_cast<std::size_t>(j)) *
                   static_cast<std::size_t>(size[0]) +
               static_cast<std::size_t>(i);
    }
    bool contains(std::int32_t i, std::int32_t j, std::int32_t k) const {
        return i >= 0 && j >= 0 && k >= 0 && i < size[0] && j < size[1] && k < size[2];
    }
    /// Maps a continuous voxel index to p_P (mm).
    Eigen::Vector3d point_of(const Eigen::Vector3d& index) const;
    /// Maps p_P (mm) to a continuous voxel index; the direction matrix must be orthonormal (asserted).
    Eigen::Vector3d index_of(const Eigen::Vector3d& p_P) const;
};

/// Tells whether two grids have the same size and, to 1e-4 mm at every corner, the same place.
bool same_grid(const ImageGrid& a, const ImageGrid& b);

/// A scalar volume; CT values are in HU.
struct Volume {
    ImageGrid grid;
    std::vector<float> values;  ///< voxel_count() values, i fastest
};

}  // namespace palpate
