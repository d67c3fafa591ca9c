// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "runtime/collision/collision_surface.hpp"

namespace palpate::collision {
namespace {

using Eigen::Vector3d;

// mm: far above the rounding of a nearest point in double, far below the distance of two float32 vertices.
constexpr double on_surface = 1e-9;

bool on_edge(const Vector3d& q, const Vector3d& a, const Vector3d& b) noexcept {
    const Vector3d edge = b - a;
    const double s = std::clamp((q - a).dot(edge) / edge.squaredNorm(), 0.0, 1.0);
    return (a + s * edge - q).norm() <= on_surface;
}

}  // namespace

double angle_about(const Vector3d& q, const TriangleCorners& t) noexcept {
    for (std::size_t i = 0; i < 3; ++i) {
        if ((q - t[i]).norm() > on_surface) continue;
        const Vector3d u = t[(i + 1) % 3] - t[i], v = t[(i + 2) % 3] - t[i];
        return std::atan2(u.cross(v).norm(), u.dot(v));
    }
    for (std::size_t i = 0; i < 3; ++i)
        if (on_edge(q, t[i], t[(i + 1) % 3])) return std::numbers::pi;
    return 2 * std::numbers::pi;
}

Vector3d CollisionSurface::pseudonormal(const Vector3d& q) const noexcept {
    Vector3d sum = Vector3d::Zero();
    std::array<std::int32_t, deepest_obb_tree + 2> stack;
    std::size_t size = 0;
    stack[size++] = 0;
    while (size > 0) {
        const ObbNode box = node(stack[--size]);
        const Vector3d local = box.axes.cast<double>() * (q - box.center.cast<double>());
        if ((local.array().abs() > box.half_extents.cast<double>().array() + on_surface).any()) continue;
        if (box.count == 0) {
            stack[size++] = box.first + 1;
            stack[size++] = box.first;
        }
        for (std::int32_t slot = box.first; slot < box.first + box.count; ++slot) {
            const TriangleCorners t = corners(slot);
            if (closest_point_on_triangle(q, t).squared_distance > on_surface * on_surface) continue;
            const Vector3d normal = unit_normal(t);
            if (normal.squaredNorm() > 0) sum += angle_about(q, t) * normal;
        }
    }
    return sum.normalized();
}

Vector3d CollisionSurface::outward_normal(const ClosestPoint& found) const noexcept {
    const Vector3d normal = unit_normal(corners(found.slot));
    return normal.squaredNorm() > 0 ? normal : pseudonormal(found.point);
}

bool CollisionSurface::is_outside(const Vector3d& p) const noexcept {
    const auto nearest = closest_point(p, std::numeric_limits<double>::max());
    return nearest && is_outside(p, *nearest);
}

}  // namespace palpate::collision
