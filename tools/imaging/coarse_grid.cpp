// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/coarse_grid.hpp"

#include <algorithm>
#include <cmath>

namespace palpate {

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

}  // namespace palpate
