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
    Vector3d from;    // to where nothing stands before it
};

std::optional<FirstHit> nearest_hit(std::span<const CollisionSurface* const> surfaces, const Vector3d& from,
                                    const Vector3d& to) {
    double nearest = 2;  // of the way: beyond its end
    std::optional<FirstHit> hit;
    for (const CollisionSurface* surface : surfaces) {
        const auto contact = surface->sweep_sphere(from, to, 0);
        if (!contact || contact->fraction >= nearest) continue;
        nearest = contact->fraction;
        hit = {contact->point, collision::unit_normal(surface->corners(contact->slot)), from};
    }
    return hit;
}

std::optional<FirstHit> first_hit(std::span<const CollisionSurface* const> surfaces, const Vector3d& from,
                                  const Vector3d& to, bool insides_drawn) {
    constexpr int most_insides = 32;
    constexpr double step = 1e-3;  // mm, past one
    const Vector3d way = (to - from).normalized();
    Vector3d start = from;
    for (int i = 0; i < most_insides && way.dot(to - start) > step; ++i) {
        const auto hit = nearest_hit(surfaces, start, to);
        if (!hit || hit->normal.dot(way) < 0) return hit;
        if (insides_drawn) break;
        start = hit->point + step * way;
    }
    return std::nullopt;
}

}  // namespace

std::optional<SeenPoint> surface_under(std::span<const CollisionSurface* const> surfaces,
                                       const Vector3d& from, const Vector3d& to, double width,
                                       bool insides_drawn) {
    const auto middle = first_hit(surfaces, from, to, insides_drawn);
    if (!middle) return std::nullopt;
    const Vector3d across = (to - from).unitOrthogonal();
    const Vector3d other = (to - from).normalized().cross(across);
    Vector3d sum = middle->normal;
    for (const Vector3d& side : {across, Vector3d(-across), other, Vector3d(-other)}) {
        const auto hit = first_hit(surfaces, from + width * side, to + width * side, insides_drawn);
        if (hit && (hit->point - middle->point).norm() < 2 * width && hit->normal.dot(middle->normal) > 0)
            sum += hit->normal;
    }
    return SeenPoint{middle->point, sum.normalized(), middle->from};
}

bool is_blocked(std::span<const CollisionSurface* const> surfaces, const Vector3d& from, const Vector3d& to,
                double radius) {
    return std::ranges::any_of(surfaces, [&](const CollisionSurface* surface) {
        return surface->sweep_sphere(from, to, radius).has_value();
    });
}

}  // namespace palpate::visual
