// SPDX-License-Identifier: Apache-2.0
#include "runtime/collision/segment_queries.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace palpate {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

// Fraction of the way from `start` over `edge` that comes nearest to p; 0 if there is no way.
double fraction_along(const Vector3d& start, const Vector3d& edge, const Vector3d& p) noexcept {
    const double squared_length = edge.squaredNorm();
    return squared_length > 0 ? std::clamp((p - start).dot(edge) / squared_length, 0.0, 1.0) : 0.0;
}

// What is still to visit, and how near it can be.
struct Pending {
    std::int32_t node;
    double squared_bound;
};

// A box whose axes are unit only to float32 seems farther by this factor than it is.
constexpr double rounding = 1 - 2e-6;

// Squared distance that the axes of box and segment, and their cross products, tell apart; at most that from
// segment a-b to anything in the box.
double squared_distance_bound(const ObbNode& box, const Vector3d& a, const Vector3d& b) noexcept {
    const Eigen::Matrix3d axes = box.axes.cast<double>();
    const Vector3d extents = box.half_extents.cast<double>();
    const Vector3d middle = axes * (0.5 * (a + b) - box.center.cast<double>());
    const Vector3d half = axes * (0.5 * (b - a));
    double bound = (middle.cwiseAbs() - half.cwiseAbs() - extents).cwiseMax(0.0).squaredNorm();
    const Vector3d off = middle.cross(half);
    for (Index k = 0; k < 3; ++k) {
        const Index i = (k + 1) % 3, j = (k + 2) % 3;
        const double excess =
            std::abs(off[k]) - extents[i] * std::abs(half[j]) - extents[j] * std::abs(half[i]);
        if (excess > 0) bound = std::max(bound, excess * excess / (half[i] * half[i] + half[j] * half[j]));
    }
    return bound * rounding;
}

}  // namespace

SegmentPair closest_points_of_segments(const Vector3d& a0, const Vector3d& a1, const Vector3d& b0,
                                       const Vector3d& b1) noexcept {
    const Vector3d u = a1 - a0, v = b1 - b0, w = a0 - b0;
    SegmentPair pair;
    if (v.squaredNorm() > 0) {
        const Vector3d normal = u.cross(v);
        const double squared = normal.squaredNorm();
        // The cross product of parallel segments is rounding only; any s then has its t.
        if (squared > 1e-30 * u.squaredNorm() * v.squaredNorm())
            pair.s = std::clamp(v.cross(w).dot(normal) / squared, 0.0, 1.0);
        pair.t = v.dot(w + pair.s * u) / v.squaredNorm();
    }
    if (!(pair.t > 0 && pair.t < 1)) {
        pair.t = pair.t > 0 ? 1 : 0;
        pair.s = fraction_along(a0, u, b0 + pair.t * v);
    }
    pair.first = a0 + pair.s * u;
    pair.second = b0 + pair.t * v;
    pair.squared_distance = (pair.first - pair.second).squaredNorm();
    return pair;
}

std::optional<SegmentTrianglePair> pierce(const Vector3d& a, const Vector3d& b,
                                          const TriangleCorners& t) noexcept {
    const Vector3d normal = unit_normal(t);  // zero, and nothing is pierced, if there is no area
    const double above_a = normal.dot(a - t[0]), above_b = normal.dot(b - t[0]);
    if (!((above_a > 0 && above_b < 0) || (above_a < 0 && above_b > 0))) return std::nullopt;
    SegmentTrianglePair pair;
    pair.fraction = above_a / (above_a - above_b);
    pair.segment_point = a + pair.fraction * (b - a);
    Vector3d& weights = pair.foot.barycentric;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vector3d &p = t[(i + 1) % 3], &q = t[(i + 2) % 3];
        weights[static_cast<Index>(i)] = (q - p).cross(pair.segment_point - p).dot(normal);
    }
    if (!(weights.minCoeff() > 0)) return std::nullopt;
    weights /= weights.sum();
    pair.foot.point = pair.segment_point;
    return pair;
}

SegmentTrianglePair closest_points_of_segment_and_triangle(const Vector3d& a, const Vector3d& b,
                                                           const TriangleCorners& t) noexcept {
    if (const auto through = pierce(a, b, t)) return *through;
    SegmentTrianglePair best{0, a, closest_point_on_triangle(a, t)};
    const TrianglePoint from_b = closest_point_on_triangle(b, t);
    if (from_b.squared_distance < best.foot.squared_distance) best = {1, b, from_b};
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3;
        const SegmentPair here = closest_points_of_segments(a, b, t[i], t[j]);
        if (!(here.squared_distance < best.foot.squared_distance)) continue;
        best = {here.s, here.first, {}};
        best.foot.point = here.second;
        best.foot.barycentric[static_cast<Index>(i)] = 1 - here.t;
        best.foot.barycentric[static_cast<Index>(j)] = here.t;
        best.foot.squared_distance = here.squared_distance;
        best.foot.feature = here.t > 0 && here.t < 1 ? Feature::edge : Feature::vertex;
    }
    return best;
}

std::optional<ClosestToSegment> closest_to_segment(const CollisionSurface& surface, const Vector3d& a,
                                                   const Vector3d& b, double max_distance) noexcept {
    SegmentTrianglePair best;
    best.foot.squared_distance = max_distance * max_distance;
    std::int32_t best_slot = -1;
    std::array<Pending, deepest_obb_tree + 2> stack;
    std::size_t size = 0;
    stack[size++] = {0, squared_distance_bound(surface.node(0), a, b)};
    while (size > 0) {
        const Pending top = stack[--size];
        // Nothing is nearer than a piercing segment.
        if (top.squared_bound > best.foot.squared_distance ||
            (best_slot >= 0 && best.foot.squared_distance == 0))
            continue;
        const ObbNode box = surface.node(top.node);
        if (box.count == 0) {
            const Pending left{box.first, squared_distance_bound(surface.node(box.first), a, b)};
            const Pending right{box.first + 1, squared_distance_bound(surface.node(box.first + 1), a, b)};
            // The nearer child is visited first: it shrinks what the other must beat.
            const bool left_first = left.squared_bound <= right.squared_bound;
            stack[size++] = left_first ? right : left;
            stack[size++] = left_first ? left : right;
        }
        for (std::int32_t slot = box.first; slot < box.first + box.count; ++slot) {
            const SegmentTrianglePair here =
                closest_points_of_segment_and_triangle(a, b, surface.corners(slot));
            const double squared = here.foot.squared_distance;
            if (squared < best.foot.squared_distance ||
                (best_slot < 0 && squared == best.foot.squared_distance)) {
                best = here;
                best_slot = slot;
            }
        }
    }
    if (best_slot < 0) return std::nullopt;
    const TrianglePoint& foot = best.foot;
    return ClosestToSegment{{foot.point, foot.barycentric, std::sqrt(foot.squared_distance),
                             surface.mesh_triangle(best_slot), best_slot, foot.feature},
                            best.fraction,
                            best.segment_point};
}

}  // namespace palpate
