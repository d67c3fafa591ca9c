// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <random>
#include <vector>

#include "formats/model/triangle_mesh.hpp"
#include "runtime/collision/collision_surface.hpp"

namespace palpate::experiments {

/// Where a straight approach onto a bone goes in, and what lies behind.
struct Place {
    static constexpr double free_way = 60;  ///< mm of way for the tool before the surface, at least

    Eigen::Vector3d entry;      ///< on the surface, p_P, mm
    Eigen::Vector3d direction;  ///< unit, inwards: against the triangle's normal
    double thickness = 0;       ///< mm of bone along the line up to where it first leaves the bone
};

/// Draws places on the outer side of a closed bone, uniform in area. A place is taken if
///   - the line outwards is free for half a metre, so it is not inside the head, and a tool of `tool_radius`
///     (mm) comes within 1 mm of it along free_way;
///   - it is part of a wall, so a tool pressed on it does not slip off an edge: 16 lines beside the approach,
///     3 and 6 mm away, meet bone no more than 2 and 4 mm before or behind the entry (a slope of 34 degrees).
/// Nothing else is asked of the bone, its thickness in particular. Throws InvalidInput if 100 000 draws in a
/// row find no place.
std::vector<Place> draw_places(const TriangleMesh& mesh, const collision::CollisionSurface& surface,
                               double tool_radius, std::size_t count, std::mt19937_64& random);

}  // namespace palpate::experiments
