// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <vector>

#include "tools/seeds/grey_presets.hpp"
#include "tools/seeds/growth.hpp"
#include "tools/seeds/slice_view.hpp"

namespace palpate::seeds {

/// One slice as pixels, a pixel a voxel, rows from the top.
struct SlicePicture {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgb;
    /// For each label number, how much of a voxel's surroundings is that label, 0 ... 1; its contour is where
    /// it is one half. Empty if the label is not on the slice.
    std::vector<std::vector<float>> cover;
};

/// Draws a slice in grey and tints what has grown there. What grows in preview comes in blocks of voxels, so
/// its share is averaged over about a block: edges come out smooth. `labels` are the names by number.
SlicePicture slice_picture(const Volume& volume, const SliceView& view, std::int32_t slice,
                           const GreyPreset& grey, const Growth* growth,
                           const std::vector<std::string>& labels);

}  // namespace palpate::seeds
