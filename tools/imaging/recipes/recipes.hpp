// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <span>
#include <string>

#include "tools/imaging/voxels/mask.hpp"

namespace palpate {

/// Voxels of lower ... upper HU, both included.
Mask threshold(const Volume& volume, double lower_hu, double upper_hu);

/// How far the values of a CT probably lie above HU: 0 if one is negative, or unless soft tissue lies about
/// the offset and little between it and air; else 1000 if the commonest value of the air (-1000 HU) lies
/// below 14, and otherwise 1024, the usual one. The air decides no finer: old scanners have it
/// tens of HU off.
double hounsfield_offset(const Volume& volume);

/// Lowest threshold for bone that is clear of soft tissue: the median of the values of -20 ... 200 HU and
/// five of their deviations (median absolute deviation), at least 150 HU above.
double bone_threshold(const Volume& volume);

/// Bone: voxels of `threshold_hu` or more in the body. The body is the largest piece of tissue (above -300
/// HU) after an opening by `separation_mm`, which cuts it from table and head rest, and what lies within
/// `separation_mm` of that piece.
Mask bone(const Volume& volume, double threshold_hu = 226, double separation_mm = 4);

/// Air passages: air (below `threshold_hu`) without the outside. The outside is the air that reaches an edge
/// of the volume, where two of its faces meet, through openings that a ball of `opening_mm` passes; so a
/// passage cut by the last slice stays. Kept are the pieces that hold a seed (p_P, mm) or, without seeds, the
/// largest. Throws InvalidInput naming `culprit` if a seed lies outside the volume or more than 2 mm from
/// such air.
Mask airway(const Volume& volume, std::span<const Eigen::Vector3d> seeds, double threshold_hu = -400,
            double opening_mm = 5, const std::string& culprit = "seed");

/// The soft wall of an air passage: voxels of lower ... upper HU outside `air` and not in `taken`, within
/// `thickness_mm` of `air` and in `region`. Gaps below `smoothing_mm` are closed, spikes below it removed,
/// holes filled, and the largest piece that touches `air` by a face is kept.
Mask soft_wall(const Volume& volume, const Mask& air, const Mask& taken, const Region& region,
               double thickness_mm = 6, double lower_hu = -400, double upper_hu = 225,
               double smoothing_mm = 1);

}  // namespace palpate
