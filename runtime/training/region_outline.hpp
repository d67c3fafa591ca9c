// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "formats/model/body.hpp"

namespace palpate::training {

/// The place of a body's surface straight above the middle of a region, from `near` (p_P, mm, on the surface)
/// on: where the area-weighted mean normal of the surface within the region's own radius runs through the
/// mean of the region's nodes. Found by going to the point of the surface over the middle along the last
/// place's normal until it moves by less than 0.1 mm, ten times at most. p_P, mm; `near` where the surface
/// about it has no normal or the middle lies beyond the body's edge. Linear in the surface.
Eigen::Vector3d place_above(const DeformableBody& body, std::int32_t region, const Eigen::Vector3d& near);

/// Draws the outline of what lies below a surface onto it, as one sees it who looks straight down at `above`
/// (p_P, mm, on the body's surface). The region's nodes are projected along n, the area-weighted mean normal
/// of the surface within the region's own radius of `above`; the outline is their convex hull across n, in
/// points at most a millimetre apart, each put along n on the surface at rest: of outward faces that it
/// meets there, on the one nearest to `above` in height. Points that meet none, beyond the body's edge, are
/// left out. Closed: the last point is followed by the first. p_P, mm; empty where the region has no extent.
/// Of several pieces of one region it is the hull of all. Linear in the surface for each point.
std::vector<Eigen::Vector3d> region_outline(const DeformableBody& body, std::int32_t region,
                                            const Eigen::Vector3d& above);

/// The distance of a point from that closed line, mm. At least one point.
double distance_to_outline(const std::vector<Eigen::Vector3d>& outline, const Eigen::Vector3d& p);

}  // namespace palpate::training
