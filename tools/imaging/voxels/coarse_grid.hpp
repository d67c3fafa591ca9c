// SPDX-License-Identifier: GPL-3.0-or-later
// For tools/imaging only: working on blocks of voxels where full resolution would only cost time.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "formats/model/image_grid.hpp"
#include "tools/imaging/voxels/mask.hpp"

namespace palpate::imaging {

/// Calls visit(i, j, k, offset) for every voxel, in memory's order.
template <typename Visit>
void for_each_voxel(const ImageGrid& grid, const Visit& visit) {
    std::size_t offset = 0;
    for (std::int32_t k = 0; k < grid.size[2]; ++k)
        for (std::int32_t j = 0; j < grid.size[1]; ++j)
            for (std::int32_t i = 0; i < grid.size[0]; ++i, ++offset) visit(i, j, k, offset);
}

/// Voxels per block along each axis, so that blocks measure about `spacing` (mm); 1 where voxels are larger.
std::array<std::int32_t, 3> blocks_of(const ImageGrid& grid, double spacing);

/// The grid of those blocks; a block cut by the border counts as whole.
ImageGrid coarse_grid(const ImageGrid& grid, const std::array<std::int32_t, 3>& block);

/// Mean value of each block.
Volume coarsen(const Volume& volume, const std::array<std::int32_t, 3>& block);

/// A block of voxels: the first and how many along each axis.
struct Box {
    std::array<std::int32_t, 3> low, size;
};

/// The smallest box that holds the mask and `margin` (mm) around it within the grid; all of the grid if the
/// mask is empty.
Box bounding_box(const Mask& mask, double margin);

Volume crop(const Volume& volume, const Box& box);
Mask crop(const Mask& mask, const Box& box);

/// A mask of blocks, cropped at block `low`, as voxels of `grid`: the blocks' values are interpolated
/// linearly between their centres and cut at one half, so that the result has no steps of a block.
Mask refine(const Mask& blocks, const std::array<std::int32_t, 3>& low,
            const std::array<std::int32_t, 3>& block, const ImageGrid& grid);

}  // namespace palpate::imaging
