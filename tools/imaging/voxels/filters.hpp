// SPDX-License-Identifier: GPL-3.0-or-later
// For tools/imaging only: grey filters.
#pragma once
#include <vector>

#include "formats/model/image_grid.hpp"

namespace palpate::imaging {

/// Weighted mean of the neighbourhood with Gaussian weights of deviation `sigma` (mm), cut off at 3 sigma and
/// normalised over the voxels that exist. Cost: voxels times 18 sigma / spacing.
void gaussian(const ImageGrid& grid, std::vector<float>& values, double sigma);

/// Length of the gradient (values per mm), by central differences after a Gaussian of deviation `sigma` (mm).
Volume gradient_length(const Volume& volume, double sigma);

/// Smooths along level sets, so that noise goes and edges stay (curvature flow, Sethian, 1999).
Volume curvature_flow(const Volume& volume, int iterations);

}  // namespace palpate::imaging
