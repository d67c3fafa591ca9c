// SPDX-License-Identifier: Apache-2.0
#include "runtime/collision/tree_pairs.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "runtime/collision/segment_queries.hpp"

namespace palpate::collision {
namespace {

using Eigen::Index;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double touching = 1e-9;  // mm: nearer triangles touch, and the way between them is no normal

// Whether the triangles lie farther than `margin` from each other along `axis`, a unit vector or zero.
bool apart_along(const Vector3d& axis, const TriangleCorners& a, const TriangleCorners& b,
                 double margin) noexcept {
    const auto [low_a, high_a] = std::minmax({axis.dot(a[0]), axis.dot(a[1]), axis.dot(a[2])});
    const auto [low_b, high_b] = std::minmax({axis.dot(b[0]), axis.dot(b[1]), axis.dot(b[2])});
    const double reach = margin + touching;  // the products lose some digits
    return low_b - high_a > reach || low_a - high_b > reach;
}

// A box about the corners of `t`, fattened by `margin`, misses that about `other`.
bool boxes_apart(const TriangleCorners& t, const TriangleCorners& other, double margin) noexcept {
    const auto low = [](const TriangleCorners& c) { return c[0].cwiseMin(c[1]).cwiseMin(c[2]); };
    const auto high = [](const TriangleCorners& c) { return c[0].cwiseMax(c[1]).cwiseMax(c[2]); };
    return ((low(t) - high(other)).array() > margin).any() || ((low(other) - high(t)).array() > margin).any();
}

// The margin as boxes see it whose axes are unit and square only to float32; the same slack goes onto every
// cosine.
constexpr double slack = 1e-6;

// Whether one of the 15 axes parts the boxes, B's placed by X_AB, by more than `margin`.
bool parted(const ObbNode& a, const ObbNode& b, const Eigen::Isometry3d& X_AB, double margin) noexcept {
    const Matrix3d axes_a = a.axes.cast<double>();
    const Matrix3d R = axes_a * X_AB.linear() * b.axes.cast<double>().transpose();
    const Vector3d t = axes_a * (X_AB * b.center.cast<double>() - a.center.cast<double>());
    const Matrix3d cosines = R.cwiseAbs().array() + slack;
    const Vector3d ea = a.half_extents.cast<double>(), eb = b.half_extents.cast<double>();
    const double reach = margin * (1 + 2 * slack);
    if ((t.cwiseAbs().array() > (ea + cosines * eb).array() + reach).any()) return true;
    if (((R.transpose() * t).cwiseAbs().array() > (eb + cosines.transpose() * ea).array() + reach).any())
        return true;
    for (Index i = 0; i < 3; ++i) {
        const Index i1 = (i + 1) % 3, i2 = (i + 2) % 3;
        for (Index j = 0; j < 3; ++j) {
            const Index j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            const double radius = ea[i1] * cosines(i2, j) + ea[i2] * cosines(i1, j) +
                                  eb[j1] * cosines(i, j2) + eb[j2] * cosines(i, j1);
            // The axis a_i x b_j is no longer than 1, so the whole margin parts no boxes that are near.
            if (std::abs(t[i2] * R(i1, j) - t[i1] * R(i2, j)) > radius + reach) return true;
        }
    }
    return false;
}

// Calls visit(slot of A, slot of B, corners of A, corners of B in A) for all triangles whose boxes are near,
// until it returns false.
template <class Visit>
void for_triangles_near(const CollisionSurface& a, const CollisionSurface& b, const Eigen::Isometry3d& X_AB,
                        double margin, const Visit& visit) noexcept {
    struct Pending {
        std::int32_t a, b;
    };
    // Each step down one of the two trees leaves at most one pair waiting.
    std::array<Pending, 2 * deepest_obb_tree + 2> stack;
    std::size_t size = 0;
    stack[size++] = {0, 0};
    while (size > 0) {
        const Pending top = stack[--size];
        const ObbNode box_a = a.node(top.a), box_b = b.node(top.b);
        if (parted(box_a, box_b, X_AB, margin)) continue;
        const bool leaf_a = box_a.count > 0, leaf_b = box_b.count > 0;
        if (!leaf_a && (leaf_b || box_a.half_extents.norm() >= box_b.half_extents.norm())) {
            stack[size++] = {box_a.first + 1, top.b};
            stack[size++] = {box_a.first, top.b};
            continue;
        }
        if (!leaf_b) {
            stack[size++] = {top.a, box_b.first + 1};
            stack[size++] = {top.a, box_b.first};
            continue;
        }
        for (std::int32_t slot_b = box_b.first; slot_b < box_b.first + box_b.count; ++slot_b) {
            TriangleCorners corners_b = b.corners(slot_b);
            for (Vector3d& corner : corners_b) corner = X_AB * corner;
            for (std::int32_t slot_a = box_a.first; slot_a < box_a.first + box_a.count; ++slot_a)
                if (!visit(slot_a, slot_b, a.corners(slot_a), corners_b)) return;
        }
    }
}

// Whether two triangles come within `margin`, and where.
bool near(const TriangleCorners& a, const TriangleCorners& b, double margin, TrianglePair& pair) noexcept {
    if (boxes_apart(a, b, margin) || apart_along(unit_normal(a), a, b, margin) ||
        apart_along(unit_normal(b), a, b, margin))
        return false;
    pair = closest_points_of_triangles(a, b);
    return pair.on_a.squared_distance <= margin * margin;
}

}  // namespace

TrianglePair closest_points_of_triangles(const TriangleCorners& a, const TriangleCorners& b) noexcept {
    TrianglePair best;
    best.on_a.squared_distance = std::numeric_limits<double>::infinity();
    const auto consider = [&](const TrianglePoint& on_a, const TrianglePoint& on_b, double squared) {
        if (!(squared < best.on_a.squared_distance)) return;
        best = {on_a, on_b, Vector3d::Zero()};
        best.on_a.squared_distance = best.on_b.squared_distance = squared;
    };
    const Vector3d normal_a = unit_normal(a), normal_b = unit_normal(b);
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t next = (i + 1) % 3;
        if (const auto through = pierce(b[i], b[next], a)) {
            consider(through->foot, edge_point(i, through->fraction, through->segment_point), 0);
            best.normal = normal_a;
            return best;
        }
        if (const auto through = pierce(a[i], a[next], b)) {
            consider(edge_point(i, through->fraction, through->segment_point), through->foot, 0);
            best.normal = -normal_b;
            return best;
        }
    }
    for (std::size_t i = 0; i < 3; ++i) {
        const TrianglePoint under_b = closest_point_on_triangle(b[i], a);
        consider(under_b, corner_point(b, i), under_b.squared_distance);
        const TrianglePoint under_a = closest_point_on_triangle(a[i], b);
        consider(corner_point(a, i), under_a, under_a.squared_distance);
        for (std::size_t j = 0; j < 3; ++j) {
            const SegmentPair edges = closest_points_of_segments(a[i], a[(i + 1) % 3], b[j], b[(j + 1) % 3]);
            consider(edge_point(i, edges.s, edges.first), edge_point(j, edges.t, edges.second),
                     edges.squared_distance);
        }
    }
    if (best.on_a.squared_distance > touching * touching)
        best.normal = (best.on_b.point - best.on_a.point).normalized();
    else
        best.normal = normal_a.squaredNorm() > 0 ? normal_a : Vector3d(-normal_b);
    return best;
}

std::size_t pairs_near(const CollisionSurface& a, const CollisionSurface& b, const Eigen::Isometry3d& X_AB,
                       double margin, std::span<SurfacePair> pairs) noexcept {
    margin = std::max(margin, touching);
    std::size_t found = 0;
    for_triangles_near(
        a, b, X_AB, margin,
        [&](std::int32_t slot_a, std::int32_t slot_b, const TriangleCorners& corners_a,
            const TriangleCorners& corners_b) {
            TrianglePair contact;
            if (!near(corners_a, corners_b, margin, contact)) return true;
            if (found < pairs.size())
                pairs[found] = {slot_a, slot_b, a.mesh_triangle(slot_a), b.mesh_triangle(slot_b), contact};
            ++found;
            return true;
        });
    return found;
}

bool surfaces_touch(const CollisionSurface& a, const CollisionSurface& b, const Eigen::Isometry3d& X_AB,
                    double margin) noexcept {
    margin = std::max(margin, touching);
    bool touch = false;
    for_triangles_near(
        a, b, X_AB, margin,
        [&](std::int32_t, std::int32_t, const TriangleCorners& corners_a, const TriangleCorners& corners_b) {
            TrianglePair contact;
            touch = near(corners_a, corners_b, margin, contact);
            return !touch;
        });
    return touch;
}

}  // namespace palpate::collision
