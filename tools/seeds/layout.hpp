// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/seeds/slice_view.hpp"

namespace palpate::seeds {

/// Where everything is in a window: axial upper left, coronal below it, sagittal beside the coronal, so that
/// neighbours share an axis; the legend upper right, a status line at the bottom. All at one scale.
struct Layout {
    std::array<PaneFrame, 3> panes;  ///< in the order of slice_views()
    PaneFrame legend, status;        ///< their corners and sizes only
};

/// Lays out a window of `size` (pixels). At zoom 1 all of each slice is seen; above, the voxel `middle` is in
/// the middle of each pane.
Layout lay_out(const ImageGrid& grid, const std::array<SliceView, 3>& views, const Eigen::Vector2d& size,
               double zoom, const std::array<std::int32_t, 3>& middle);

}  // namespace palpate::seeds
