// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <optional>
#include <string>

#include "formats/model/image_grid.hpp"

namespace palpate::seeds {

/// How the slices across one index axis of a volume are shown: each index axis counts as the patient's axis
/// it is closest to, so oblique, flipped and left-handed volumes are shown in their own slices. Radiological
/// display: the patient's right is at the left of an axial and a coronal picture, the front at the left of a
/// sagittal one, the front on top of an axial picture, the head on top of the others.
///
/// Pane coordinates (u, v) are mm from the picture's upper left corner, the outer corner of its first voxel,
/// to the right and down.
struct SliceView {
    std::string name;             ///< "axial", "coronal" or "sagittal"
    int across = 2;               ///< index axis that counts slices
    int right = 0, down = 1;      ///< index axes along the picture's rows and columns
    bool right_flipped = false;   ///< the index decreases to the right
    bool down_flipped = false;    ///< the index decreases downwards
    int away = 1;                 ///< +1 or -1: how the slice number changes away from the viewer
    std::array<char, 4> edges{};  ///< what lies towards left, right, top, bottom: of R L A P S I
};

/// The axial, the coronal and the sagittal view of a grid, whose directions must be orthonormal (asserted).
std::array<SliceView, 3> slice_views(const ImageGrid& grid);

/// Width and height of a view's pictures in mm.
Eigen::Vector2d size_of(const SliceView& view, const ImageGrid& grid);

/// Pane coordinates of a continuous voxel index, dropping the distance from the slice.
Eigen::Vector2d pane_point(const SliceView& view, const ImageGrid& grid, const Eigen::Vector3d& index);

/// Continuous voxel index of a place on a slice; nothing outside the volume.
std::optional<Eigen::Vector3d> index_at(const SliceView& view, const ImageGrid& grid, std::int32_t slice,
                                        const Eigen::Vector2d& point);

/// The part of the window, in pixels from its lower left corner, that a view is drawn in, and what it shows.
struct PaneFrame {
    Eigen::Vector2d corner = Eigen::Vector2d::Zero();  ///< lower left corner, pixels
    Eigen::Vector2d size = Eigen::Vector2d::Ones();    ///< pixels
    Eigen::Vector2d center = Eigen::Vector2d::Zero();  ///< pane coordinates in its middle, mm
    double pixel = 1;                                  ///< mm

    bool holds(const Eigen::Vector2d& position) const;
    /// Pane coordinates of a position in the window.
    Eigen::Vector2d point_at(const Eigen::Vector2d& position) const;
    /// Tells whether pane coordinates are well within what is seen: not in its outermost twentieth.
    bool shows(const Eigen::Vector2d& point) const;
};

}  // namespace palpate::seeds
