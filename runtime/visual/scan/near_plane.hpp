// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <vtkRenderer.h>

#include "runtime/visual/scan/scan_plane.hpp"

namespace palpate::visual {

/// What a renderer's camera sees of its near plane.
ScanPlane near_plane(vtkRenderer* renderer);

/// Half that plane's width and height by its distance: where a ray through the picture meets it.
Eigen::Vector2d near_reach(vtkRenderer* renderer);

/// Whether two planes show the same to a fiftieth of a texel of that size (mm).
bool show_the_same(const ScanPlane& a, const ScanPlane& b, double texel);

}  // namespace palpate::visual
