// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
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

using Rgb = std::array<std::uint8_t, 3>;

/// The nearest bytes of a colour of 0 ... 1.
Rgb rgb_of(const std::array<float, 3>& colour);

/// A picture of one colour.
Picture blank(int width, int height, const Rgb& colour);

/// Draws a picture, a filled rectangle, or text in a sans-serif face of `size` pixels onto another picture,
/// its upper left corner at (x, y); what lies beyond the border is left out. Text needs no display.
void paste(Picture& onto, const Picture& picture, int x, int y);
void fill(Picture& onto, int x, int y, int width, int height, const Rgb& colour);
void write_words(Picture& onto, int x, int y, const std::string& text, int size, const Rgb& colour);

/// Encodes a picture as PNG and returns the file's bytes.
std::string png_bytes(const Picture& picture);

}  // namespace palpate::report
