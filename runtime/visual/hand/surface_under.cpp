// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/hand/surface_under.hpp"

#include <Eigen/Geometry>
#include <algorithm>

namespace palpate::visual {
namespace {

using collision::CollisionSurface;
using Eigen::Vector3d;

struct FirstHit {
    Vector3d point;
    Vector3d normal;  // of the triangle, unit
};

std::optional<FirstHit> first_hit(std::span<const CollisionSurface* const> surfaces, const Vector3d& from,
                                  const Vector3d& to) {
    double nearest = 2;  // of the way: beyond its end
    std::optional<FirstHit> hit;
    for (const CollisionSurface* surface : surfaces) {
        const auto contact = surface->sweep_sphere(from, to, 0);
        if (!contact || contact->fraction >= nearest) continue;
        nearest = contact->fraction;
        hit = {contact->point, collision::unit_normal(surface->corners(contact->slot))};
    }
    if (hit && hit->normal.dot(to - from) >= 0) return std::nullopt;
    return hit;
}

}  // namespace

std::optional<SeenPoint> surface_under(std::span<const CollisionSurface* const> surfaces,
                                       const Vector3d& from, const Vector3d& to, double width) {
    const auto middle = first_hit(surfaces, from, to);
    if (!middle) return std::nullopt;
    const Vector3d across = (to - from).unitOrthogonal();
    const Vector3d other = (to - from).normalized().cross(across);
    Vector3d sum = middle->normal;
    for (const Vector3d& side : {across, Vector3d(-across), other, Vector3d(-other)}) {
        const auto hit = first_hit(surfaces, from + width * side, to + width * side);
        if (hit && (hit->point - middle->point).norm() < 2 * width && hit->normal.dot(middle->normal) > 0)
            sum += hit->normal;
    }
    return SeenPoint{middle->point, sum.normalized(), from};
}

bool is_blocked(std::span<const CollisionSurface* const> surfaces, const Vector3d& from, const Vector3d& to,
                double radius) {
    return std::ranges::any_of(surfaces, [&](const CollisionSurface* surface) {
        return surface->sweep_sphere(from, to, radius).has_value();
    });
}

}  // namespace palpate::visual
