// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <vtkCamera.h>
#include <vtkRenderer.h>

#include "runtime/visual/scan/scan_plane.hpp"
#include "runtime/visual/sight.hpp"

namespace palpate::visual {

/// Leaves out what lies nearer before the eye than that, mm; never so near that depth loses its precision.
void clip_before(vtkCamera* camera, double depth);

/// Leaves out whatever stands between the eye and a sight's target, or between it and a tool of that radius
/// (mm) at that place (p_P, mm), and leaves some room before them.
void clip_before(vtkCamera* camera, const Sight& sight, const Eigen::Vector3d& tool, double tool_radius);

/// What a renderer's camera sees of its near plane.
ScanPlane near_plane(vtkRenderer* renderer);

/// Half that plane's width and height by its distance: where a ray through the picture meets it.
Eigen::Vector2d near_reach(vtkRenderer* renderer);

/// Whether two planes show the same to a fiftieth of a texel of that size (mm).
bool show_the_same(const ScanPlane& a, const ScanPlane& b, double texel);

}  // namespace palpate::visual
