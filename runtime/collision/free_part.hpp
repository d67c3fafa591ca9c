// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <span>

#include "runtime/collision/collision_surface.hpp"

namespace palpate::collision {

/// How much of the way between two places (p_P, mm) a sphere of that radius (mm) goes before it touches one
/// of the surfaces, 0 to 1: see CollisionSurface::sweep_sphere().
inline double free_part(std::span<const CollisionSurface* const> surfaces, const Eigen::Vector3d& from,
                        const Eigen::Vector3d& to, double radius) noexcept {
    double part = 1;
    for (const CollisionSurface* surface : surfaces)
        if (const auto contact = surface->sweep_sphere(from, to, radius))
            part = std::min(part, contact->fraction);
    return part;
}

}  // namespace palpate::collision
