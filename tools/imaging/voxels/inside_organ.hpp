// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <span>
#include <string>

#include "tools/imaging/voxels/mask.hpp"

namespace palpate {

/// Finds the lesion that holds the seeds (p_P, mm), darker or brighter than the organ around it: voxels of
/// the organ, of its holes and within `margin_mm` of it whose smoothed grey value is nearer to that within 3
/// mm of the seeds than to the organ's median, cut at necks so that it does not run out along vessels or the
/// border. Throws InvalidInput naming `culprit` and the seed if there is no seed, if one lies outside the
/// organ, or if the grey values there cannot be told from the organ's (less than 1.5 standard deviations
/// apart).
Mask lesion(const Volume& volume, const Mask& organ, std::span<const Eigen::Vector3d> seeds, double margin_mm,
            const std::string& culprit);

/// Finds bright tubes: voxels at least `contrast_hu` above the Gaussian mean of their surroundings (deviation
/// 2 max_radius_mm, within `inside` or, where that is empty, within everything above -200), without what
/// a ball of `max_radius_mm` fits into and without what is more than 150 HU brighter than the seeds (bone).
/// Kept are the pieces that hold seeds (p_P, mm) or, without seeds, all. Throws InvalidInput naming `culprit`
/// if there is neither an inside nor a seed, or if a seed is not within 3 mm of such a voxel.
Mask vessels(const Volume& volume, const Mask* inside, std::span<const Eigen::Vector3d> seeds,
             double contrast_hu, double max_radius_mm, const std::string& culprit);

}  // namespace palpate
