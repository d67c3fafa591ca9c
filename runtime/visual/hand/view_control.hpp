// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <vtkCamera.h>
#include <vtkRenderer.h>

#include "runtime/visual/sight.hpp"

namespace palpate::visual {

/// Unit directions of the view, frame P: to the right, up, towards the eye.
std::array<Eigen::Vector3d, 3> view_axes(vtkCamera* camera);

/// Puts the eye where a sight has it, with its angle and its up.
void look_from(vtkCamera* camera, const Sight& sight);

/// What a pixel shows: from the near to the far end of what is drawn there, p_P, mm. `x` from the left, `y`
/// from below, pixels.
std::array<Eigen::Vector3d, 2> segment_under(vtkRenderer* renderer, double x, double y);

/// What a drag by dx, dy pixels does to the view: turns it about its middle, rolls it about the line of
/// sight, or moves it in its plane, so that what lies as deep as the focus stays under the pointer.
void turn_view(vtkCamera* camera, double dx, double dy);
void roll_view(vtkCamera* camera, double dx);
void pan_view(vtkCamera* camera, double dx, double dy, int window_height);

/// How far something that lies so deep before the eye (mm) goes in the view's plane to stay under a pointer
/// that is dragged by dx, dy pixels, frame P, mm.
Eigen::Vector3d way_of_drag(vtkCamera* camera, double dx, double dy, double depth, int window_height);

/// How far before the eye a place (p_P, mm) lies, along the way it looks, mm.
double depth_of(vtkCamera* camera, const Eigen::Vector3d& place);

}  // namespace palpate::visual
