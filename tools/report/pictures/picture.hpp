// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace palpate::report {

/// An RGB raster, rows from the top, three bytes a pixel.
struct Picture {
    int width = 0;
    int height = 0;
    std::vector<std::uint8_t> rgb;

    std::size_t offset(int x, int y) const {
        return 3 *
               (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
    }
};

/// The mean of each square of `factor` by `factor` pixels; what is left over at the right and below is
/// dropped.
Picture shrunk(const Picture& picture, int factor);

/// Encodes a picture as PNG and returns the file's bytes.
std::string png_bytes(const Picture& picture);

}  // namespace palpate::report
