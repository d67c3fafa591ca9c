// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/seeds/slice_picture.hpp"

#include <algorithm>
#include <cmath>

#include "tools/seeds/seed_state.hpp"

namespace palpate::seeds {
namespace {

constexpr float tint = 0.28F;  // of the label's colour inside its contour

// Calls f(pixel, voxel offset) for every pixel of a slice.
template <typename F>
void each_pixel(const ImageGrid& grid, const SliceView& view, std::int32_t slice, F f) {
    const auto count = [&](int axis) { return grid.size[axis]; };
    std::size_t pixel = 0;
    std::array<std::int32_t, 3> index{};
    index[view.across] = slice;
    for (std::int32_t row = 0; row < count(view.down); ++row)
        for (std::int32_t column = 0; column < count(view.right); ++column) {
            index[view.right] = view.right_flipped ? count(view.right) - 1 - column : column;
            index[view.down] = view.down_flipped ? count(view.down) - 1 - row : row;
            f(pixel++, grid.offset(index[0], index[1], index[2]));
        }
}

// Mean over 2 * radius + 1 neighbours along one axis; beyond the ends the last value goes on.
void blur(std::vector<float>& values, int count, std::ptrdiff_t stride, int lines, int line_stride,
          int radius) {
    if (radius <= 0) return;
    std::vector<float> line(static_cast<std::size_t>(count));
    for (int n = 0; n < lines; ++n) {
        float* const first = values.data() + static_cast<std::ptrdiff_t>(n) * line_stride;
        const auto at = [&](int i) { return line[std::clamp(i, 0, count - 1)]; };
        for (int i = 0; i < count; ++i) line[i] = first[i * stride];
        float sum = 0;
        for (int i = -radius; i <= radius; ++i) sum += at(i);
        for (int i = 0; i < count; ++i) {
            first[i * stride] = sum / static_cast<float>(2 * radius + 1);
            sum += at(i + radius + 1) - at(i - radius);
        }
    }
}

}  // namespace

SlicePicture slice_picture(const Volume& volume, const SliceView& view, std::int32_t slice,
                           const GreyPreset& grey, const Growth* growth,
                           const std::vector<std::string>& labels) {
    const ImageGrid& grid = volume.grid;
    SlicePicture picture;
    picture.width = grid.size[view.right];
    picture.height = grid.size[view.down];
    const auto pixels = static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height);
    picture.rgb.resize(3 * pixels);
    picture.cover.resize(labels.size());
    each_pixel(grid, view, slice, [&](std::size_t pixel, std::size_t voxel) {
        const auto shade = static_cast<std::uint8_t>(std::lround(255 * grey.shade(volume.values[voxel])));
        std::fill_n(picture.rgb.begin() + static_cast<std::ptrdiff_t>(3 * pixel), 3, shade);
    });
    if (growth == nullptr || growth->map.labels.empty()) return picture;

    std::vector<std::uint16_t> shown(pixels);
    each_pixel(grid, view, slice,
               [&](std::size_t pixel, std::size_t voxel) { shown[pixel] = growth->map.labels[voxel]; });
    const auto radius = [&](int axis) {
        return static_cast<int>(std::lround(growth->block_mm / grid.spacing[axis] / 2));
    };
    for (const Label& label : growth->map.names) {
        const auto number = std::ranges::find(labels, label.name) - labels.begin();
        if (number == std::ssize(labels) || std::ranges::find(shown, label.value) == shown.end()) continue;
        std::vector<float>& cover = picture.cover.at(static_cast<std::size_t>(number));
        cover.resize(pixels);
        std::ranges::transform(shown, cover.begin(),
                               [&](std::uint16_t value) { return value == label.value ? 1.0F : 0.0F; });
        for (int pass = 0; pass < 2; ++pass) {
            blur(cover, picture.width, 1, picture.height, picture.width, radius(view.right));
            blur(cover, picture.height, picture.width, picture.width, 1, radius(view.down));
        }
        const auto colour = label_colour(static_cast<std::size_t>(number));
        for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
            const float share = tint * std::clamp(3 * cover[pixel] - 1, 0.0F, 1.0F);
            for (std::size_t channel = 0; channel < 3; ++channel) {
                std::uint8_t& byte = picture.rgb[3 * pixel + channel];
                const float mixed = (1 - share) * byte + share * 255 * colour[channel];
                byte = static_cast<std::uint8_t>(std::clamp(mixed, 0.0F, 255.0F));
            }
        }
    }
    return picture;
}

}  // namespace palpate::seeds
