// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "runtime/collision/triangle_queries.hpp"

namespace palpate::collision {

/// The convex hull of three balls: a triangle that is round at its edges and corners.
struct RoundedTriangle {
    TriangleCorners centres;                          ///< mm
    Eigen::Vector3d radii = Eigen::Vector3d::Zero();  ///< of the balls, >= 0, mm
};

/// The ball of a rounded triangle whose surface is nearest to a query point.
struct NearestBall {
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();       ///< on the triangle of the centres, mm
    Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();  ///< weights of the corners, >= 0, sum 1
    double radius = 0;                                      ///< mm
    double distance = 0;                                    ///< of the query point from the ball's centre, mm
    Feature feature = Feature::face;
};

/// Finds where |p - q| - rho(q) is least for q on the triangle of the centres, rho being the balls' radius
/// linearly between them: that is the distance of p (mm) from the hull, negative inside near its surface. Its
/// gradient by p is n = (p - q) / |p - q|, and by a centre -w n with its weight w, whatever the radii. Where
/// a radius changes by more along an edge than the edge is long, one corner's ball holds the other's. All is
/// finite (unchecked). Realtime-safe. The hull is that of sphere-meshes (Thiery, Guy, Boubekeur 2013).
NearestBall nearest_ball(const Eigen::Vector3d& p, const RoundedTriangle& t) noexcept;

}  // namespace palpate::collision
