// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>

#include "formats/model/triangle_mesh.hpp"

namespace palpate::collision {

/// What of a triangle a point lies on.
enum class Feature : std::uint8_t { face, edge, vertex };

using TriangleCorners = std::array<Eigen::Vector3d, 3>;  ///< mm

/// Where the corners of one of a mesh's triangles are, mm.
inline TriangleCorners corners_of(const TriangleMesh& mesh, const Triangle& t) {
    const auto vertex = [&](std::size_t i) { return mesh.vertices[static_cast<std::size_t>(t[i])]; };
    return {vertex(0), vertex(1), vertex(2)};
}

/// The unit normal of triangle `t`, (t1 - t0) x (t2 - t0) normalised; zero where that is rounding only.
/// Realtime-safe.
Eigen::Vector3d unit_normal(const TriangleCorners& t) noexcept;

/// The angle of the part of `t` about its point q, both mm, for a triangle with area: 2 pi on its face, pi on
/// an edge, the corner's angle at a corner. The weight of its normal in the angle-weighted normal at q
/// (Baerentzen, Aanaes 2005). Realtime-safe.
double angle_about(const Eigen::Vector3d& q, const TriangleCorners& t) noexcept;

/// The point of a triangle nearest to a query point.
struct TrianglePoint {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();        ///< mm
    Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();  ///< weights of the corners, >= 0, sum 1
    double squared_distance = 0;                            ///< mm²
    Feature feature = Feature::face;
};

/// Corner i of a triangle as a point of it. Realtime-safe.
inline TrianglePoint corner_point(const TriangleCorners& t, std::size_t i) noexcept {
    return {t[i], Eigen::Vector3d::Unit(static_cast<Eigen::Index>(i)), 0, Feature::vertex};
}
/// The point p of edge i, from corner i to the next, that is at fraction s of it. Realtime-safe.
inline TrianglePoint edge_point(std::size_t i, double s, const Eigen::Vector3d& p) noexcept {
    TrianglePoint point{p, Eigen::Vector3d::Zero(), 0, s > 0 && s < 1 ? Feature::edge : Feature::vertex};
    point.barycentric[static_cast<Eigen::Index>(i)] = 1 - s;
    point.barycentric[static_cast<Eigen::Index>((i + 1) % 3)] = s;
    return point;
}

/// Finds the point of triangle `t` nearest to p (Ericson, Real-Time Collision Detection, 2005, 5.1.5);
/// triangles without area count as their edges. Realtime-safe.
TrianglePoint closest_point_on_triangle(const Eigen::Vector3d& p, const TriangleCorners& t) noexcept;

/// The first touch of a moving sphere and one triangle.
struct TriangleContact {
    double fraction = 0;                               ///< of the way, 0 ... limit
    Eigen::Vector3d point = Eigen::Vector3d::Zero();   ///< touched point, mm
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< unit, from the point to the sphere's centre
};

/// Finds the smallest s in [0, limit] at which the sphere of `radius` (mm) about from + s * way touches
/// triangle `t`. The sphere touches where its centre enters the sum of triangle and ball, whose boundary is
/// two plates, three cylinders about the edges and three balls about the corners; each is intersected
/// exactly. If the sphere overlaps the triangle at s = 0, that is the touch if `way` leads deeper, otherwise
/// there is none: the distance to a convex set that does not fall at first never falls. Realtime-safe.
std::optional<TriangleContact> sweep_sphere_triangle(const Eigen::Vector3d& from, const Eigen::Vector3d& way,
                                                     double radius, double limit,
                                                     const TriangleCorners& t) noexcept;

}  // namespace palpate::collision
