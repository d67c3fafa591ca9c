// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/drop_mark.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace palpate::visual {

using collision::CollisionSurface;
using Eigen::Vector3d;

std::optional<DropMark> drop_mark(std::span<const CollisionSurface* const> surfaces, const Vector3d& tool,
                                  double radius, double reach) {
    constexpr double touching_radii = 1.03;  // what a tool in contact keeps of a rigid surface
    constexpr double lift_radii = 0.12;      // above the surface, which the picture has only nearly
    const CollisionSurface* below = nullptr;
    std::optional<collision::ClosestPoint> nearest;
    for (const CollisionSurface* surface : surfaces) {
        const auto found = surface->closest_point(tool, nearest ? nearest->distance : radius + reach);
        if (!found || (nearest && found->distance >= nearest->distance)) continue;
        nearest = found;
        below = surface;
    }
    if (!nearest || nearest->distance <= touching_radii * radius || !below->is_outside(tool, *nearest))
        return std::nullopt;

    const Vector3d normal = (tool - nearest->point).normalized();
    const Vector3d across = normal.unitOrthogonal(), other = normal.cross(across);
    DropMark mark;
    mark.foot = nearest->point + lift_radii * radius * normal;
    mark.gap = nearest->distance - radius;
    const double ring_radius = radius + 0.5 * mark.gap;
    for (std::size_t i = 0; i < DropMark::ring_points; ++i) {
        const double angle = 2 * std::numbers::pi * static_cast<double>(i) / DropMark::ring_points;
        const Vector3d flat =
            nearest->point + ring_radius * (std::cos(angle) * across + std::sin(angle) * other);
        const auto draped = below->closest_point(flat, ring_radius, nearest->slot);
        mark.ring[i] = (draped ? draped->point : flat) + lift_radii * radius * normal;
    }
    return mark;
}

}  // namespace palpate::visual
