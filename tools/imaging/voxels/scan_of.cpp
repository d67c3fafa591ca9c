// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/voxels/scan_of.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "tools/imaging/voxels/coarse_grid.hpp"
#include "tools/imaging/voxels/hounsfield.hpp"

namespace palpate::imaging {
namespace {

std::optional<Box> box_around(const ImageGrid& grid, std::span<const Eigen::Vector3d> points, double margin) {
    Eigen::AlignedBox3d extent;  // of voxel indices
    for (const Eigen::Vector3d& p : points) extent.extend(grid.index_of(p));
    const Eigen::Vector3d more = grid.spacing.cwiseInverse() * margin;
    const Eigen::AlignedBox3d part =
        Eigen::AlignedBox3d(extent.min() - more, extent.max() + more)
            .intersection({Eigen::Vector3d::Zero(),
                           Eigen::Vector3d(grid.size[0] - 1, grid.size[1] - 1, grid.size[2] - 1)});
    if (part.isEmpty()) return std::nullopt;
    constexpr double rounding = 1e-6;  // voxels
    Box box{};
    for (int axis = 0; axis < 3; ++axis) {
        box.low[axis] = static_cast<std::int32_t>(std::floor(part.min()[axis] + rounding));
        box.size[axis] =
            static_cast<std::int32_t>(std::ceil(part.max()[axis] - rounding)) + 1 - box.low[axis];
    }
    return box;
}

std::array<std::int32_t, 3> fitting_blocks(const ImageGrid& grid, std::size_t most_voxels) {
    std::array<std::int32_t, 3> block{1, 1, 1};
    for (ImageGrid coarse = grid; coarse.voxel_count() > most_voxels; coarse = coarse_grid(grid, block)) {
        const double finest = 1.01 * coarse.spacing.minCoeff();  // what rounding makes of equal ones
        const bool in_slices = coarse.spacing.head<2>().minCoeff() <= finest;
        for (int axis = in_slices ? 0 : 2; axis < (in_slices ? 2 : 3); ++axis)
            if (coarse.spacing[axis] <= finest) ++block[axis];
    }
    return block;
}

// What is taken off a value, and by what the rest is multiplied, so that 16 bits hold it.
struct Storage {
    bool hounsfield;
    double zero, scale;
};

Storage storage_of(const Volume& volume) {
    if (const double offset = hounsfield_offset(volume); offset > 0 || holds_air(volume))
        return {true, offset, 1};
    constexpr double least = -32768, largest = 32767, telling = 255, scaled = 4095;
    const auto [low, high] = std::ranges::minmax(volume.values);
    if (low >= least && high <= largest && high - low >= telling) return {false, 0, 1};
    return {false, low, scaled / std::max(static_cast<double>(high) - low, 1e-30)};
}

}  // namespace

std::optional<Scan> scan_of(const Volume& volume, std::span<const Eigen::Vector3d> points,
                            const ScanLimits& limits) {
    const auto box = box_around(volume.grid, points, limits.margin);
    if (!box) return std::nullopt;
    const Storage storage = storage_of(volume);
    Volume part = crop(volume, *box);
    const auto blocks = fitting_blocks(part.grid, limits.most_bytes / sizeof(std::int16_t));
    if (blocks != std::array{1, 1, 1}) part = coarsen(part, blocks);
    Scan scan{part.grid, storage.hounsfield, {}};
    scan.values.reserve(part.values.size());
    for (const float value : part.values)
        scan.values.push_back(static_cast<std::int16_t>(
            std::lround(std::clamp((value - storage.zero) * storage.scale, -32768.0, 32767.0))));
    return scan;
}

}  // namespace palpate::imaging
