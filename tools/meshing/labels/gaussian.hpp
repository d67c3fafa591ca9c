// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <vector>

namespace palpate::meshing {

/// Where the Gaussian is cut off, in units of sigma.
inline constexpr double gaussian_reach = 3.0;

/// A box of floats to be smoothed.
struct FloatImage {
    std::array<std::int32_t, 3> size{0, 0, 0};
    std::array<double, 3> sigma_voxels{0, 0, 0};  ///< per axis; 0 leaves the axis as it is
    std::vector<float> values;                    ///< i fastest
};

/// Smooths by a separable Gaussian whose weights sum to one; beyond the box lie zeros. The same bytes on
/// every run.
void smooth(FloatImage& image);

}  // namespace palpate::meshing
