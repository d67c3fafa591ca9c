// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/voxels/seed_statistics.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <set>

#include "formats/model/errors.hpp"
#include "tools/imaging/voxels/mask.hpp"

namespace palpate::imaging {
namespace {

double median(std::vector<float>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    return *middle;
}

}  // namespace

GreyStatistics robust_statistics(std::vector<float>& values) {
    constexpr double sigma_per_mad = 1.4826;  // of a normal distribution
    if (values.empty()) return {};
    const double mean = median(values);
    for (float& value : values) value = std::abs(value - static_cast<float>(mean));
    return {mean, sigma_per_mad * median(values)};
}

std::vector<float> values_near(const Volume& volume, std::span<const Eigen::Vector3d> points, double radius) {
    const ImageGrid& grid = volume.grid;
    std::set<std::size_t> found;
    for (const Eigen::Vector3d& point : points) {
        const auto [low, high] = voxels_around(grid, point, radius);
        for (int k = low[2]; k <= high[2]; ++k)
            for (int j = low[1]; j <= high[1]; ++j)
                for (int i = low[0]; i <= high[0]; ++i)
                    if ((grid.point_of(Eigen::Vector3d(i, j, k)) - point).squaredNorm() <= radius * radius)
                        found.insert(grid.offset(i, j, k));
        const Eigen::Array3i nearest = grid.index_of(point).array().round().cast<int>();
        if (grid.contains(nearest[0], nearest[1], nearest[2]))
            found.insert(grid.offset(nearest[0], nearest[1], nearest[2]));
    }
    std::vector<float> values;
    for (const std::size_t offset : found) values.push_back(volume.values[offset]);
    return values;
}

std::array<std::int32_t, 3> voxel_of_seed(const ImageGrid& grid, const Eigen::Vector3d& p_P,
                                          const std::string& culprit) {
    const Eigen::Vector3d index = grid.index_of(p_P).array().round();
    Eigen::Vector3d low = Eigen::Vector3d::Constant(INFINITY), high = -low;
    for (int corner = 0; corner < 8; ++corner) {
        Eigen::Vector3d at;
        for (int axis = 0; axis < 3; ++axis) at[axis] = (corner >> axis & 1) != 0 ? grid.size[axis] - 1 : 0;
        low = low.cwiseMin(grid.point_of(at));
        high = high.cwiseMax(grid.point_of(at));
    }
    for (Eigen::Index axis = 0; axis < 3; ++axis)
        if (!(index[axis] >= 0 && index[axis] < grid.size[axis]))
            throw InvalidInput({culprit, "seed " + point_text(p_P) + " lies outside the volume",
                                "between " + point_text(low) + " and " + point_text(high),
                                "give points in LPS mm; 3D Slicer shows RAS, with x and y negated"});
    return {static_cast<std::int32_t>(index[0]), static_cast<std::int32_t>(index[1]),
            static_cast<std::int32_t>(index[2])};
}

std::vector<std::size_t> voxels_at(const Mask& mask, std::span<const Eigen::Vector3d> seeds,
                                   const std::string& culprit, const std::string& expected,
                                   const std::string& next_step) {
    std::vector<std::size_t> found;
    for (const Eigen::Vector3d& seed : seeds) {
        const auto voxel = nearest_voxel(mask, seed, seed_miss_mm);
        if (!voxel)
            throw InvalidInput({culprit, "seed " + point_text(seed) + " is not there", expected, next_step});
        found.push_back(*voxel);
    }
    return found;
}

std::string point_text(const Eigen::Vector3d& p_P) {
    const auto rounded = [](double value) { return std::round(value * 100) / 100; };
    return fmt::format("({}, {}, {}) mm", rounded(p_P[0]), rounded(p_P[1]), rounded(p_P[2]));
}

}  // namespace palpate::imaging
