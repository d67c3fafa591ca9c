// SPDX-License-Identifier: GPL-3.0-or-later
// For this folder only: working on blocks of voxels where full resolution would only cost time.
#pragma once
#include <array>
#include <cstdint>

#include "formats/model/image_grid.hpp"

namespace palpate {

/// Voxels per block along each axis, so that blocks measure about `spacing` (mm); 1 where voxels are larger.
std::array<std::int32_t, 3> blocks_of(const ImageGrid& grid, double spacing);

/// The grid of those blocks; a block cut by the border counts as whole.
ImageGrid coarse_grid(const ImageGrid& grid, const std::array<std::int32_t, 3>& block);

/// Mean value of each block.
Volume coarsen(const Volume& volume, const std::array<std::int32_t, 3>& block);

}  // namespace palpate
