// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

#include "formats/model/image_grid.hpp"

namespace palpate {

/// The image that bodies were made from, cut to their size and reduced: for the eye alone, for nothing that
/// is felt follows from it.
struct Scan {
    ImageGrid grid;
    bool hounsfield = false;           ///< values are HU of a CT; otherwise grey values of no unit
    std::vector<std::int16_t> values;  ///< voxel_count() values, i fastest
};

}  // namespace palpate
