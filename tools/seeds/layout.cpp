// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/seeds/layout.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::seeds {

using Eigen::Vector2d;

Layout lay_out(const ImageGrid& grid, const std::array<SliceView, 3>& views, const Vector2d& size,
               double zoom, const std::array<std::int32_t, 3>& middle) {
    constexpr double status_height = 30, gap = 2, margin = 26;  // pixels; letters stand in the margin
    constexpr double least_share = 0.42, largest_share = 0.62;  // of a side, for the axial pane
    const Vector2d axial = size_of(views[0], grid), coronal = size_of(views[1], grid),
                   sagittal = size_of(views[2], grid);
    const auto split = [&](double first, double second, double length) {
        return std::round(length * std::clamp(first / (first + second), least_share, largest_share));
    };
    const double height = size[1] - status_height;
    const double left = split(axial[0], sagittal[0], size[0]), top = split(axial[1], coronal[1], height);
    const auto frame = [&](double x, double y, double width, double tall) {
        return PaneFrame{{x, y}, {std::max(1.0, width - gap), std::max(1.0, tall - gap)}, {0, 0}, 0};
    };
    const double bottom = height - top, right = size[0] - left;
    Layout layout{{frame(0, status_height + bottom, left, top), frame(0, status_height, left, bottom),
                   frame(left, status_height, right, bottom)},
                  frame(left, status_height + bottom, right, top),
                  frame(0, 0, size[0], status_height)};

    double pixel = 0;  // mm
    for (std::size_t n = 0; n < 3; ++n) {
        const Eigen::Array2d room = (layout.panes[n].size.array() - 2 * margin).max(1);
        pixel = std::max(pixel, (size_of(views[n], grid).array() / room).maxCoeff());
    }
    const Eigen::Vector3d index(middle[0], middle[1], middle[2]);
    for (std::size_t n = 0; n < 3; ++n) {
        layout.panes[n].pixel = pixel / zoom;
        layout.panes[n].center =
            zoom > 1 ? pane_point(views[n], grid, index) : Vector2d(size_of(views[n], grid) / 2);
    }
    return layout;
}

}  // namespace palpate::seeds
