// SPDX-License-Identifier: GPL-3.0-or-later
// For tools/imaging only: where a mask that ran from one organ into the next is to be cut.
#pragma once
#include <span>

#include "tools/imaging/voxels/mask.hpp"

namespace palpate::imaging {

/// The part of a mask that belongs to the given voxels (offsets inside the mask) when the mask is cut at its
/// necks. A watershed of the distance from the mask's border divides it into bodies; two bodies stay one if
/// the largest ball that passes between them has at least `neck_ratio` of the radius of the largest ball in
/// the smaller of them. Kept are the bodies that hold one of the voxels. `depth` is that distance (mm).
/// Deterministic; cost: linear in voxels apart from one sort by depth.
/// Source: Vincent and Soille (1991), with merging by the dynamics of the saddle (Najman and Schmitt, 1996).
Mask cut_at_necks(const Mask& mask, std::span<const float> depth, std::span<const std::size_t> inside,
                  double neck_ratio);

}  // namespace palpate::imaging
