// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/voxels/coarse_grid.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::imaging {
namespace {

ImageGrid cropped_grid(const ImageGrid& grid, const Box& box) {
    ImageGrid part = grid;
    part.size = box.size;
    part.origin = grid.point_of(Eigen::Vector3d(box.low[0], box.low[1], box.low[2]));
    return part;
}

template <typename Value>
std::vector<Value> cropped(const ImageGrid& grid, const std::vector<Value>& values, const Box& box) {
    std::vector<Value> part;
    for (std::int32_t k = 0; k < box.size[2]; ++k)
        for (std::int32_t j = 0; j < box.size[1]; ++j) {
            const auto row = values.begin() + static_cast<std::ptrdiff_t>(
                                                  grid.offset(box.low[0], box.low[1] + j, box.low[2] + k));
            part.insert(part.end(), row, row + box.size[0]);
        }
    return part;
}

}  // namespace

std::array<std::int32_t, 3> blocks_of(const ImageGrid& grid, double spacing) {
    std::array<std::int32_t, 3> block{};
    for (std::size_t axis = 0; axis < 3; ++axis)
        block[axis] = std::max(1, static_cast<std::int32_t>(
                                      std::round(spacing / grid.spacing[static_cast<Eigen::Index>(axis)])));
    return block;
}

ImageGrid coarse_grid(const ImageGrid& grid, const std::array<std::int32_t, 3>& block) {
    ImageGrid coarse = grid;
    const Eigen::Vector3d step(block[0], block[1], block[2]);
    for (std::size_t axis = 0; axis < 3; ++axis)
        coarse.size[axis] = (grid.size[axis] + block[axis] - 1) / block[axis];
    coarse.spacing = grid.spacing.cwiseProduct(step);
    coarse.origin = grid.point_of((step.array() - 1) / 2);
    return coarse;
}

Volume coarsen(const Volume& volume, const std::array<std::int32_t, 3>& block) {
    Volume coarse{coarse_grid(volume.grid, block), {}};
    coarse.values.assign(coarse.grid.voxel_count(), 0.0F);
    const auto& size = volume.grid.size;
    for (std::int32_t k = 0; k < size[2]; ++k)
        for (std::int32_t j = 0; j < size[1]; ++j) {
            const float* from = &volume.values[volume.grid.offset(0, j, k)];
            float* to = &coarse.values[coarse.grid.offset(0, j / block[1], k / block[2])];
            for (std::int32_t i = 0; i < size[0]; ++i) to[i / block[0]] += from[i];
        }
    const auto in_block = [&](std::size_t axis, std::int32_t index) {
        return std::min(block[axis], size[axis] - index * block[axis]);
    };
    std::size_t offset = 0;
    for (std::int32_t k = 0; k < coarse.grid.size[2]; ++k)
        for (std::int32_t j = 0; j < coarse.grid.size[1]; ++j)
            for (std::int32_t i = 0; i < coarse.grid.size[0]; ++i, ++offset)
                coarse.values[offset] /= static_cast<float>(in_block(0, i) * in_block(1, j) * in_block(2, k));
    return coarse;
}

Box bounding_box(const Mask& mask, double margin) {
    const auto& size = mask.grid.size;
    std::array<std::int32_t, 3> low = size, high{-1, -1, -1};
    std::size_t offset = 0;
    for (std::int32_t k = 0; k < size[2]; ++k)
        for (std::int32_t j = 0; j < size[1]; ++j)
            for (std::int32_t i = 0; i < size[0]; ++i, ++offset) {
                if (!mask.voxels[offset]) continue;
                const std::array at{i, j, k};
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    low[axis] = std::min(low[axis], at[axis]);
                    high[axis] = std::max(high[axis], at[axis]);
                }
            }
    if (high[0] < 0) return {{0, 0, 0}, size};
    Box box{};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto more =
            static_cast<std::int32_t>(std::ceil(margin / mask.grid.spacing[static_cast<Eigen::Index>(axis)]));
        box.low[axis] = std::max(0, low[axis] - more);
        box.size[axis] = std::min(size[axis], high[axis] + more + 1) - box.low[axis];
    }
    return box;
}

Volume crop(const Volume& volume, const Box& box) {
    return {cropped_grid(volume.grid, box), cropped(volume.grid, volume.values, box)};
}

Mask crop(const Mask& mask, const Box& box) {
    return {cropped_grid(mask.grid, box), cropped(mask.grid, mask.voxels, box)};
}

Mask refine(const Mask& blocks, const std::array<std::int32_t, 3>& low,
            const std::array<std::int32_t, 3>& block, const ImageGrid& grid) {
    struct Between {
        std::int32_t first, second;
        float share;  // of the second
    };
    // For each voxel along an axis the two blocks it lies between; outside the crop nothing is inside.
    std::array<std::vector<Between>, 3> between;
    for (std::size_t axis = 0; axis < 3; ++axis)
        for (std::int32_t voxel = 0; voxel < grid.size[axis]; ++voxel) {
            const double at = (voxel - (block[axis] - 1) / 2.0) / block[axis] - low[axis];
            const auto first = static_cast<std::int32_t>(std::floor(at));
            const std::int32_t last = blocks.grid.size[axis] - 1;
            const bool inside = first >= -1 && first <= last;
            between[axis].push_back({inside ? std::clamp(first, 0, last) : -1,
                                     inside ? std::clamp(first + 1, 0, last) : -1,
                                     static_cast<float>(at - first)});
        }
    Mask result{grid, std::vector<std::uint8_t>(grid.voxel_count(), 0)};
    std::size_t offset = 0;
    for (const Between& z : between[2])
        for (const Between& y : between[1])
            for (const Between& x : between[0]) {
                const std::size_t here = offset++;
                if (x.first < 0 || y.first < 0 || z.first < 0) continue;
                const auto along_x = [&](std::int32_t j, std::int32_t k) {
                    const float a = blocks.voxels[blocks.grid.offset(x.first, j, k)],
                                b = blocks.voxels[blocks.grid.offset(x.second, j, k)];
                    return a + x.share * (b - a);
                };
                const auto along_y = [&](std::int32_t k) {
                    const float a = along_x(y.first, k), b = along_x(y.second, k);
                    return a + y.share * (b - a);
                };
                const float a = along_y(z.first), b = along_y(z.second);
                result.voxels[here] = a + z.share * (b - a) >= 0.5F;
            }
    return result;
}

}  // namespace palpate::imaging
