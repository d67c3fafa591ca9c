// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <span>

#include "formats/model/image_grid.hpp"
#include "formats/model/scan.hpp"

namespace palpate::imaging {

/// How much of a volume scan_of() keeps.
struct ScanLimits {
    double margin = 10;                   ///< mm, around what is shown
    std::size_t most_bytes = 12'000'000;  ///< of voxels
};

/// Cuts a volume to the box, along its own axes, of `points` (p_P, mm) and a margin, and takes the mean over
/// blocks of whole voxels until it fits: along the axes with the finest voxels first, of equal ones in the
/// slices before across them. A CT's values come in HU, stored as they are or as value + 1000 or + 1024;
/// other values are kept where 16 bits hold and tell them, and scaled to 0 ... 4095 otherwise. None if the
/// volume shows nothing of the box. Preconditions, unchecked: at least one point, an orthonormal direction.
/// Linear in voxels and points; takes memory for the part once more.
std::optional<Scan> scan_of(const Volume& volume, std::span<const Eigen::Vector3d> points,
                            const ScanLimits& limits = {});

}  // namespace palpate::imaging
