// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "runtime/collision/collision_surface.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// What is still to visit, and how near it can be.
struct Pending {
    std::int32_t node;
    float squared_bound;
};

// A box seems nearer by this factor than float32 makes it.
constexpr float rounding = 1 - 2e-6F;

ClosestPoint from_triangle_point(const TrianglePoint& found, std::int32_t slot) noexcept {
    return {found.point, found.barycentric, std::sqrt(found.squared_distance), 0, slot, found.feature};
}

}  // namespace

// Squared distance from p to the box; at most the squared distance to anything in it.
float CollisionSurface::squared_distance_bound(const Node& node, const Vector3f& p) noexcept {
    const float x = p[0] - node.center[0], y = p[1] - node.center[1], z = p[2] - node.center[2];
    float sum = 0;
    for (int row = 0; row < 3; ++row) {
        const float* axis = node.axes + 3 * row;
        const float outside = std::abs(axis[0] * x + axis[1] * y + axis[2] * z) - node.half_extents[row];
        const float beyond = outside > 0 ? outside : 0;
        sum += beyond * beyond;
    }
    return sum * rounding;
}

// Whether the segment middle +- half, fattened by radius, may meet the box: separating axes of the box alone.
bool CollisionSurface::may_touch(const Node& node, const Vector3f& middle, const Vector3f& half,
                                 float radius) noexcept {
    const float x = middle[0] - node.center[0], y = middle[1] - node.center[1],
                z = middle[2] - node.center[2];
    for (int row = 0; row < 3; ++row) {
        const float* axis = node.axes + 3 * row;
        const float away = std::abs(axis[0] * x + axis[1] * y + axis[2] * z) * rounding;
        const float reach = std::abs(axis[0] * half[0] + axis[1] * half[1] + axis[2] * half[2]);
        if (away > node.half_extents[row] + reach + radius) return false;
    }
    return true;
}

std::optional<ClosestPoint> CollisionSurface::closest_point(const Vector3d& p, double max_distance,
                                                            std::int32_t hint) const noexcept {
    TrianglePoint best;
    best.squared_distance = max_distance * max_distance;
    std::int32_t best_slot = -1;
    const auto test = [&](std::int32_t slot) {
        const TrianglePoint here = closest_point_on_triangle(p, corners(slot));
        if (here.squared_distance < best.squared_distance ||
            (best_slot < 0 && here.squared_distance == best.squared_distance)) {
            best = here;
            best_slot = slot;
        }
    };
    if (hint >= 0 && hint < triangle_count()) test(hint);

    const Vector3f p_float = p.cast<float>();
    std::array<Pending, max_depth + 2> stack;
    std::size_t size = 0;
    stack[size++] = {0, squared_distance_bound(nodes_[0], p_float)};
    while (size > 0) {
        const Pending top = stack[--size];
        if (!(static_cast<double>(top.squared_bound) <= best.squared_distance)) continue;
        const std::int32_t link = nodes_[static_cast<std::size_t>(top.node)].link;
        if (link < 0) {
            const Leaf leaf = leaves_[static_cast<std::size_t>(-1 - link)];
            for (std::int32_t slot = leaf.first; slot < leaf.first + leaf.count; ++slot)
                if (slot != hint) test(slot);
            continue;
        }
        const auto left = static_cast<std::size_t>(link);
        const Pending a{link, squared_distance_bound(nodes_[left], p_float)};
        const Pending b{link + 1, squared_distance_bound(nodes_[left + 1], p_float)};
        // The nearer child is visited first: it shrinks what the other must beat.
        const bool a_first = a.squared_bound <= b.squared_bound;
        stack[size++] = a_first ? b : a;
        stack[size++] = a_first ? a : b;
    }
    if (best_slot < 0) return std::nullopt;
    ClosestPoint result = from_triangle_point(best, best_slot);
    result.triangle = mesh_triangle(best_slot);
    return result;
}

std::optional<SweepContact> CollisionSurface::sweep_sphere(const Vector3d& from, const Vector3d& to,
                                                           double radius, std::int32_t hint) const noexcept {
    const Vector3d way = to - from;
    const double length = way.norm();
    if (!(length > 0)) return std::nullopt;
    SweepContact best;
    best.fraction = 1;
    best.slot = -1;
    const auto test = [&](std::int32_t slot) {
        const auto contact = sweep_sphere_triangle(from, way, radius, best.fraction, corners(slot));
        if (!contact || (best.slot >= 0 && contact->fraction >= best.fraction)) return;
        best = {contact->fraction, contact->point, contact->normal, mesh_triangle(slot), slot};
    };
    if (hint >= 0 && hint < triangle_count()) test(hint);

    const Vector3f from_float = from.cast<float>();
    const auto radius_float = static_cast<float>(radius);
    std::array<Pending, max_depth + 2> stack;
    std::size_t size = 0;
    stack[size++] = {0, 0};
    while (size > 0 && !(best.slot >= 0 && best.fraction <= 0)) {
        const Pending top = stack[--size];
        const double reach = radius + best.fraction * length;
        if (static_cast<double>(top.squared_bound) > reach * reach) continue;
        const std::int32_t link = nodes_[static_cast<std::size_t>(top.node)].link;
        if (link < 0) {
            const Leaf leaf = leaves_[static_cast<std::size_t>(-1 - link)];
            for (std::int32_t slot = leaf.first; slot < leaf.first + leaf.count; ++slot)
                if (slot != hint) test(slot);
            continue;
        }
        const Vector3f half = (0.5 * best.fraction * way).cast<float>();
        const Vector3f middle = from_float + half;
        const auto consider = [&](std::int32_t child, Pending& pending) {
            const Node& node = nodes_[static_cast<std::size_t>(child)];
            pending = {child, may_touch(node, middle, half, radius_float)
                                  ? squared_distance_bound(node, from_float)
                                  : std::numeric_limits<float>::infinity()};
        };
        Pending near, far;
        consider(link, near);
        consider(link + 1, far);
        if (far.squared_bound < near.squared_bound) std::swap(near, far);
        if (std::isfinite(far.squared_bound)) stack[size++] = far;
        if (std::isfinite(near.squared_bound)) stack[size++] = near;
    }
    if (best.slot < 0) return std::nullopt;
    return best;
}

std::size_t CollisionSurface::slots_near(const Vector3d& a, const Vector3d& b, double radius,
                                         std::span<std::int32_t> slots) const noexcept {
    const Vector3f half = (0.5 * (b - a)).cast<float>();
    const Vector3f middle = (0.5 * (a + b)).cast<float>();
    const auto radius_float = static_cast<float>(radius);
    std::size_t found = 0;
    std::array<std::int32_t, max_depth + 2> stack;
    std::size_t size = 0;
    stack[size++] = 0;
    while (size > 0) {
        const Node& node = nodes_[static_cast<std::size_t>(stack[--size])];
        if (!may_touch(node, middle, half, radius_float)) continue;
        if (node.link >= 0) {
            stack[size++] = node.link + 1;
            stack[size++] = node.link;
            continue;
        }
        const Leaf leaf = leaves_[static_cast<std::size_t>(-1 - node.link)];
        for (std::int32_t slot = leaf.first; slot < leaf.first + leaf.count; ++slot, ++found)
            if (found < slots.size()) slots[found] = slot;
    }
    return found;
}

bool CollisionSurface::is_outside(const Vector3d& p) const noexcept {
    const auto nearest = closest_point(p, std::numeric_limits<double>::max());
    if (!nearest) return false;
    std::array<std::int32_t, 64> near;  // more triangles than meet at a vertex of any sound mesh
    const double touching = 1e-6;       // mm: shared corners are equal bit for bit
    const std::size_t found =
        std::min(near.size(), slots_near(nearest->point, nearest->point, touching, near));
    double side = 0;
    for (std::size_t i = 0; i < found; ++i) {
        const TriangleCorners t = corners(near[i]);
        if (closest_point_on_triangle(nearest->point, t).squared_distance > touching * touching) continue;
        const Vector3d normal = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
        const double height = normal.dot(p - nearest->point);
        if (std::abs(height) > std::abs(side)) side = height;
    }
    return side > 0;
}

}  // namespace palpate
