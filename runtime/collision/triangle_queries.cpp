// SPDX-License-Identifier: Apache-2.0
#include "runtime/collision/triangle_queries.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace palpate::collision {
namespace {

using Eigen::Vector3d;

constexpr std::array<std::array<std::size_t, 2>, 3> edges{{{0, 1}, {1, 2}, {2, 0}}};

TrianglePoint make_point(const Vector3d& p, const TriangleCorners& t, double a, double b, double c,
                         Feature feature) noexcept {
    TrianglePoint result;
    result.point = a * t[0] + b * t[1] + c * t[2];
    result.squared_distance = (p - result.point).squaredNorm();
    result.barycentric = {a, b, c};
    result.feature = feature;
    return result;
}

TrianglePoint closest_point_on_edges(const Vector3d& p, const TriangleCorners& t) noexcept {
    double least = std::numeric_limits<double>::infinity(), along = 0;
    std::size_t nearest = 0;
    for (std::size_t i = 0; i < 3; ++i) {
        const Vector3d edge = t[(i + 1) % 3] - t[i], way = p - t[i];
        const double squared_length = edge.squaredNorm();
        const double s = squared_length > 0 ? std::clamp(way.dot(edge) / squared_length, 0.0, 1.0) : 0.0;
        const double squared_distance = (way - s * edge).squaredNorm();
        if (squared_distance >= least) continue;
        least = squared_distance;
        along = s;
        nearest = i;
    }
    std::array<double, 3> weights{};
    weights[nearest] = 1 - along;
    weights[(nearest + 1) % 3] = along;
    return make_point(p, t, weights[0], weights[1], weights[2],
                      along > 0 && along < 1 ? Feature::edge : Feature::vertex);
}

// The edges, and the face if p lies over it by cross products from its foot, which lose half the digits that
// products of lengths lose.
TrianglePoint closest_point_on_thin_triangle(const Vector3d& p, const TriangleCorners& t) noexcept {
    TrianglePoint best = closest_point_on_edges(p, t);
    const Vector3d normal = unit_normal(t);
    const Vector3d foot = p - normal.dot(p - t[0]) * normal;
    Vector3d weights;
    for (std::size_t i = 0; i < 3; ++i)
        weights[static_cast<Eigen::Index>(i)] =
            normal.dot((t[(i + 1) % 3] - foot).cross(t[(i + 2) % 3] - foot));
    if (!(weights.minCoeff() > 0)) return best;
    const double sum = weights.sum();
    const TrianglePoint here =
        make_point(p, t, weights[0] / sum, weights[1] / sum, weights[2] / sum, Feature::face);
    return here.squared_distance < best.squared_distance ? here : best;
}

// The smaller root of |from + s way - axis(s)|² = r², written as a s² + 2 b s + c = 0 with a > 0; nothing if
// the motion does not approach (b >= 0) or misses. Outside (c > 0) both roots are positive; the form c / (-b
// + root) loses no digits where contact is near.
std::optional<double> first_root(double a, double b, double c) noexcept {
    if (!(b < 0) || !(a > 0)) return std::nullopt;
    const double discriminant = b * b - a * c;
    if (discriminant < 0) return std::nullopt;
    return std::max(0.0, c / (-b + std::sqrt(discriminant)));
}

}  // namespace

Vector3d unit_normal(const TriangleCorners& t) noexcept {
    const Vector3d ab = t[1] - t[0], ac = t[2] - t[0];
    const Vector3d cross = ab.cross(ac);
    const double length = cross.norm();
    // Relative to the edges, 1e-14 is fifty times what a cross product loses.
    return length > 1e-14 * ab.norm() * ac.norm() ? Vector3d(cross / length) : Vector3d::Zero();
}

TrianglePoint closest_point_on_triangle(const Vector3d& p, const TriangleCorners& t) noexcept {
    const Vector3d ab = t[1] - t[0], ac = t[2] - t[0], ap = p - t[0];
    const double d1 = ab.dot(ap), d2 = ac.dot(ap);
    if (d1 <= 0 && d2 <= 0) return make_point(p, t, 1, 0, 0, Feature::vertex);
    const Vector3d bp = p - t[1];
    const double d3 = ab.dot(bp), d4 = ac.dot(bp);
    if (d3 >= 0 && d4 <= d3) return make_point(p, t, 0, 1, 0, Feature::vertex);
    const Vector3d cp = p - t[2];
    const double d5 = ab.dot(cp), d6 = ac.dot(cp);
    if (d6 >= 0 && d5 <= d6) return make_point(p, t, 0, 0, 1, Feature::vertex);

    // Twice the signed areas of (p, b, c), (p, c, a), (p, a, b) in the triangle's plane, times twice its
    // area.
    const double va = d3 * d6 - d5 * d4, vb = d5 * d2 - d1 * d6, vc = d1 * d4 - d3 * d2;
    const double sum = va + vb + vc;
    // Relative to the edges, 1e-6 is where these differences have lost ten digits.
    if (sum <= 1e-6 * ab.squaredNorm() * ac.squaredNorm()) return closest_point_on_thin_triangle(p, t);
    if (!(va > 0 && vb > 0 && vc > 0)) return closest_point_on_edges(p, t);
    return make_point(p, t, va / sum, vb / sum, vc / sum, Feature::face);
}

namespace {

// The touch of a sphere that overlaps the triangle at the start: now, if `way` leads deeper.
std::optional<TriangleContact> touch_at_start(const Vector3d& from, const Vector3d& way,
                                              const Vector3d& face_normal,
                                              const TriangleCorners& t) noexcept {
    const TrianglePoint start = closest_point_on_triangle(from, t);
    const double distance = std::sqrt(start.squared_distance);
    if (distance > 0) {
        const Vector3d normal = (from - start.point) / distance;
        if (way.dot(normal) >= 0) return std::nullopt;
        return TriangleContact{0, start.point, normal};
    }
    // The centre lies on the triangle: whichever way leads through it is deeper.
    const double along = way.dot(face_normal);
    if (along == 0) return std::nullopt;
    return TriangleContact{0, start.point, along < 0 ? face_normal : Vector3d(-face_normal)};
}

}  // namespace

std::optional<TriangleContact> sweep_sphere_triangle(const Vector3d& from, const Vector3d& way, double radius,
                                                     double limit, const TriangleCorners& t) noexcept {
    const Vector3d ab = t[1] - t[0], ac = t[2] - t[0], cross = ab.cross(ac);
    const double twice_area = cross.norm();
    // A needle's plane is too uncertain to rule anything out by.
    const bool sound = twice_area > 1e-4 * (ab.squaredNorm() + ac.squaredNorm());
    Vector3d face_normal = twice_area > 0 ? Vector3d(cross / twice_area) : Vector3d::Zero();
    if (face_normal.dot(from - t[0]) < 0) face_normal = -face_normal;
    const double height = face_normal.dot(from - t[0]);
    const double descent = -face_normal.dot(way);
    // A point within rounding of an edge is on the face: no gap between a face and its neighbour.
    const double slack = -1e-12 * twice_area * twice_area;
    const auto on_face = [&](const Vector3d& point) {
        const auto inside = [&](std::size_t i, std::size_t j) {
            return (t[j] - t[i]).cross(point - t[i]).dot(cross) >= slack;
        };
        return inside(0, 1) && inside(1, 2) && inside(2, 0);
    };
    TriangleContact best{limit, Vector3d::Zero(), Vector3d::Zero()};
    bool found = false;
    double earliest = 0;  // edges are not reached before the plane, but their roots lose half the digits
    const auto consider = [&](double root, const Vector3d& point) {
        const double fraction = std::max(root, earliest);
        if (fraction > best.fraction || (found && fraction == best.fraction)) return;
        const Vector3d offset = from + fraction * way - point;
        const double length = offset.norm();
        best = {fraction, point, length > 0 ? Vector3d(offset / length) : face_normal};
        found = true;
    };
    if (height >= radius && twice_area > 0) {
        // Clear of the triangle's plane, the sphere must get down to it first.
        const double fraction =
            descent > 0 ? (height - radius) / descent : std::numeric_limits<double>::infinity();
        if (sound && height > radius && fraction > limit) return std::nullopt;
        if (descent > 0) {
            const Vector3d point = from + fraction * way - radius * face_normal;
            if (sound) earliest = fraction;
            if (fraction <= limit && on_face(point)) {
                if (sound) return TriangleContact{fraction, point, face_normal};
                consider(fraction, point);
            }
        }
    } else if (twice_area > 0 && on_face(from - height * face_normal)) {
        return touch_at_start(from, way, face_normal, t);
    }

    const double speed_squared = way.squaredNorm();
    for (const auto& [i, j] : edges) {
        const Vector3d edge = t[j] - t[i], m = from - t[i];
        const double ee = edge.squaredNorm(), ew = edge.dot(way), em = edge.dot(m);
        const double corner_c = m.squaredNorm() - radius * radius;
        if (corner_c <= 0) return touch_at_start(from, way, face_normal, t);
        if (const auto corner = first_root(speed_squared, m.dot(way), corner_c)) consider(*corner, t[i]);
        if (!(ee > 0)) continue;
        // The part of the motion and of the start across the edge.
        const double along_way = ew / ee, along_start = em / ee;
        const Vector3d across = m - edge * along_start;
        const double side_c = across.squaredNorm() - radius * radius;
        if (side_c <= 0 && along_start >= 0 && along_start <= 1)
            return touch_at_start(from, way, face_normal, t);
        const Vector3d across_way = way - edge * along_way;
        const auto side = first_root(across_way.squaredNorm(), across.dot(across_way), side_c);
        if (!side) continue;
        const double along = along_start + *side * along_way;
        if (along >= 0 && along <= 1) consider(*side, t[i] + along * edge);
    }
    return found ? std::optional(best) : std::nullopt;
}

}  // namespace palpate::collision
