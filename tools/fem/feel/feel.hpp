// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <cstddef>
#include <string>
#include <vector>

#include "formats/model/body.hpp"

namespace palpate::fem {

/// How deep a tool of this radius is pressed where the stiffness of a surface is stated, both mm: until it
/// has sunk in by half, but no less than `palpate touch` presses unless told otherwise.
inline double feel_depth(double tool_radius) {
    constexpr double least_depth = 3;
    return std::max(least_depth, tool_radius);
}

/// Vertices near a region whose stiffness without it is solved for, at most.
inline constexpr std::size_t most_felt_vertices = 256;

/// Computes what can be felt of a condensed body with a sphere of this radius, mm, pressed feel_depth() deep:
/// the stiffness of the surface from the stored compliance (pressed_stiffness()), and what each region but
/// the largest makes of it. Without a region means: with the material of the region that it shares most of
/// its border with. That is solved at the most_felt_vertices vertices nearest to the region's nodes, of which
/// the one with the largest contrast counts. The variation there is that of the stiffness without the region
/// where a hand slides to without turning round: over vertices whose normals are within 60 degrees of the one
/// there, within twice the distance to the region's farthest node.
/// Throws InvalidInput if the compliance does not fit the contact nodes. Cost: spread_compliances(), and for
/// each region solved_compliances(). Memory: the sparse factor.
Feel feel_of(const DeformableBody& body, double tool_radius, int threads);

/// What would be felt of a region that were otherwise, where it is felt best as it is.
struct FeltTrial {
    std::string change;  ///< "2 times as stiff", "half as deep", "a tool of 2.5 mm radius"
    FeltRegion felt;     ///< with that change
    FeltVerdict verdict;
};

/// Tries a region that is twice as stiff (or soft, if it is softer than what is around it), half as deep, and
/// half as large again, each with tissue moved between the regions of the same mesh by the tetrahedra's
/// centroids, and a tool of half and of twice the radius (the latter unless it would need another disc), all
/// pressed as deep as it was. `felt` is of body.feel, which must be there. Cost: five solved_compliances() of
/// one vertex.
std::vector<FeltTrial> felt_trials(const DeformableBody& body, const FeltRegion& felt, int threads);

}  // namespace palpate::fem
