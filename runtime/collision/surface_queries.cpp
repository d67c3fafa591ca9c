// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "runtime/collision/collision_surface.hpp"
#include "runtime/collision/lanes.hpp"

namespace palpate::collision {
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

// A box's axes (nine floats by columns, with others behind) times (x, y, z); the fourth lane is whatever lies
// behind three in memory.
Float4 rotated(const float* axes, float x, float y, float z) noexcept {
    return load(axes) * x + load(axes + 3) * y + load(axes + 6) * z;
}

// Sum of the squares of what `value` has beyond `limit`, over three lanes.
float squared_excess(Float4 value, Float4 limit) noexcept {
    const Float4 excess = value - limit;
    const Float4 beyond = excess > 0 ? excess : Float4{};
    const Float4 squared = beyond * beyond;
    return squared[0] + squared[1] + squared[2];
}

}  // namespace

// A segment from `from` over 2 `half`, fattened by `radius`.
struct CollisionSurface::Reach {
    Vector3f from, half;
    float radius;
};

// Squared distance from p to the box; at most the squared distance to anything in it.
float CollisionSurface::squared_distance_bound(const Node& node, const Vector3f& p) noexcept {
    const Float4 local =
        rotated(node.axes, p[0] - node.center[0], p[1] - node.center[1], p[2] - node.center[2]);
    return squared_excess(absolute(local), load(node.half_extents)) * rounding;
}

// The same from the segment's start; infinite if the fat segment misses the box along one of the box's axes.
float CollisionSurface::squared_distance_bound(const Node& node, const Reach& reach) noexcept {
    const Vector3f& p = reach.from;
    const Float4 local =
        rotated(node.axes, p[0] - node.center[0], p[1] - node.center[1], p[2] - node.center[2]);
    const Float4 half = rotated(node.axes, reach.half[0], reach.half[1], reach.half[2]);
    const Float4 extents = load(node.half_extents);
    const auto misses = absolute(local + half) * rounding > extents + absolute(half) + reach.radius;
    if (misses[0] | misses[1] | misses[2]) return std::numeric_limits<float>::infinity();
    return squared_excess(absolute(local), extents) * rounding;
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
    std::array<Pending, deepest_obb_tree + 2> stack;
    std::size_t size = 0;
    stack[size++] = {0, squared_distance_bound(nodes_[0], p_float)};
    while (size > 0) {
        const Pending top = stack[--size];
        if (!(static_cast<double>(top.squared_bound) <= best.squared_distance)) continue;
        const std::int32_t link = nodes_[top.node].link;
        if (link < 0) {
            const Leaf leaf = leaves_[-1 - link];
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
    return ClosestPoint{
        best.point, best.barycentric, std::sqrt(best.squared_distance), mesh_triangle(best_slot),
        best_slot,  best.feature};
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
        if (!contact || !comes_before(contact->fraction, slot, best)) return;
        best = {contact->fraction, contact->point, contact->normal, mesh_triangle(slot), slot};
    };
    if (hint >= 0 && hint < triangle_count()) test(hint);

    const Vector3f from_float = from.cast<float>();
    const auto radius_float = static_cast<float>(radius);
    std::array<Pending, deepest_obb_tree + 2> stack;
    std::size_t size = 0;
    stack[size++] = {0, 0};
    while (size > 0) {
        const Pending top = stack[--size];
        const double reach = radius + best.fraction * length;
        if (static_cast<double>(top.squared_bound) > reach * reach) continue;
        const std::int32_t link = nodes_[top.node].link;
        if (link < 0) {
            const Leaf leaf = leaves_[-1 - link];
            for (std::int32_t slot = leaf.first; slot < leaf.first + leaf.count; ++slot)
                if (slot != hint) test(slot);
            continue;
        }
        const Vector3f half = (0.5 * best.fraction * way).cast<float>();
        const Reach rest{from_float, half, radius_float};
        const auto left = static_cast<std::size_t>(link);
        Pending near{link, squared_distance_bound(nodes_[left], rest)};
        Pending far{link + 1, squared_distance_bound(nodes_[left + 1], rest)};
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
    const Reach reach{a.cast<float>(), half, static_cast<float>(radius)};
    std::size_t found = 0;
    std::array<std::int32_t, deepest_obb_tree + 2> stack;
    std::size_t size = 0;
    stack[size++] = 0;
    while (size > 0) {
        const Node& node = nodes_[stack[--size]];
        if (!std::isfinite(squared_distance_bound(node, reach))) continue;
        if (node.link >= 0) {
            stack[size++] = node.link + 1;
            stack[size++] = node.link;
            continue;
        }
        const Leaf leaf = leaves_[-1 - node.link];
        for (std::int32_t slot = leaf.first; slot < leaf.first + leaf.count; ++slot, ++found)
            if (found < slots.size()) slots[found] = slot;
    }
    return found;
}

NearWalk CollisionSurface::walk_near(const Vector3f& centre, float reach) const noexcept {
    NearWalk walk;
    walk.centre = centre;
    walk.reach = reach;
    walk.passed_over = std::numeric_limits<float>::infinity();
    walk.nodes[walk.pending++] = 0;
    return walk;
}

bool CollisionSurface::next_leaf(NearWalk& walk, int& nodes,
                                 std::array<std::int32_t, 2>& slots) const noexcept {
    for (; walk.pending > 0 && nodes > 0; --nodes) {
        const std::int32_t link = nodes_[walk.nodes[--walk.pending]].link;
        if (link < 0) {
            const Leaf leaf = leaves_[-1 - link];
            slots = {leaf.first, leaf.count};
            --nodes;
            return true;
        }
        for (const std::int32_t child : {link + 1, link}) {
            const Node& node = nodes_[static_cast<std::size_t>(child)];
            const float squared = squared_distance_bound(node, walk.centre);
            if (squared > walk.reach * walk.reach) {
                walk.passed_over = std::min(walk.passed_over, std::sqrt(squared));
                continue;
            }
            walk.nodes[walk.pending++] = child;
            // What is visited next is in the cache by then.
            if (node.link >= 0) {
                __builtin_prefetch(&nodes_[static_cast<std::size_t>(node.link)]);
                __builtin_prefetch(&nodes_[static_cast<std::size_t>(node.link) + 1]);
            } else {
                const Leaf leaf = leaves_[static_cast<std::size_t>(-1 - node.link)];
                __builtin_prefetch(&discs_[static_cast<std::size_t>(leaf.first)]);
                __builtin_prefetch(&discs_[static_cast<std::size_t>(leaf.first + leaf.count - 1)]);
            }
        }
    }
    return false;
}

}  // namespace palpate::collision
