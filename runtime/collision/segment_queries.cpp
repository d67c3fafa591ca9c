// SPDX-License-Identifier: Apache-2.0
#include "runtime/collision/segment_queries.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace palpate::collision {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

// Fraction of the way from `start` over `edge` that comes nearest to p; 0 if there is no way.
double fraction_along(const Vector3d& start, const Vector3d& edge, const Vector3d& p) noexcept {
    const double squared_length = edge.squaredNorm();
    return squared_length > 0 ? std::clamp((p - start).dot(edge) / squared_length, 0.0, 1.0) : 0.0;
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

}  // namespace palpate::collision
