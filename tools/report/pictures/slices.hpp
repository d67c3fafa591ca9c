// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <utility>
#include <vector>

#include "formats/model/image_grid.hpp"
#include "formats/model/label_map.hpp"
#include "formats/model/triangle_mesh.hpp"
#include "tools/report/pictures/picture.hpp"

namespace palpate::report {

enum class Plane { axial, coronal, sagittal };

/// A square window in one of the patient's planes. Radiological display: the patient's right is at the left
/// of an axial and a coronal picture, the front at the left of a sagittal one.
struct SliceWindow {
    Plane plane = Plane::axial;
    Eigen::Vector3d center = Eigen::Vector3d::Zero();  ///< p_P, mm
    double side = 100;                                 ///< mm
    int pixels = 560;                                  ///< along a side

    Eigen::Vector3d right() const;   ///< unit direction of picture columns in P
    Eigen::Vector3d down() const;    ///< unit direction of picture rows in P
    Eigen::Vector3d normal() const;  ///< right x down
    /// Maps p_P to pixel coordinates, dropping the distance from the plane.
    Eigen::Vector2d pixel_of(const Eigen::Vector3d& p_P) const;
};

/// Which values are drawn black and which white.
struct GreyWindow {
    float black = 0;
    float white = 1;
    bool hounsfield = false;  ///< a CT, told by values of -500 or less, as air has
};

/// Chooses -250 ... 650 HU for a CT, the 1st ... 99th percentile for anything else.
GreyWindow grey_window(const Volume& volume);

/// Draws what the window shows, grey as `grey` says, resampled in the patient frame, so grids may be oblique
/// or flipped and need not agree: the volume in grey (nothing without one), labels tinted with a contour in
/// their own colour.
Picture slice_picture(const SliceWindow& window, const Volume* volume, const LabelMap* labels,
                      const GreyWindow& grey);
/// The same with the volume's grey_window().
Picture slice_picture(const SliceWindow& window, const Volume* volume, const LabelMap* labels);

/// Cuts a surface with the window's plane: segments in pixel coordinates, those within the window only.
std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> slice_outline(const SliceWindow& window,
                                                                       const TriangleMesh& surface);

}  // namespace palpate::report
