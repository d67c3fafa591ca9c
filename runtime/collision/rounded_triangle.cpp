// SPDX-License-Identifier: Apache-2.0
#include "runtime/collision/rounded_triangle.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace palpate::collision {
namespace {

using Eigen::Vector3d;

NearestBall ball_at(const Vector3d& p, const RoundedTriangle& t, const Vector3d& weights,
                    Feature feature) noexcept {
    NearestBall ball;
    ball.barycentric = weights;
    ball.centre = weights[0] * t.centres[0] + weights[1] * t.centres[1] + weights[2] * t.centres[2];
    ball.radius = weights.dot(t.radii);
    ball.distance = (p - ball.centre).norm();
    ball.feature = feature;
    return ball;
}

// Along an edge the nearest ball lies off the foot of p by d sigma / sqrt(1 - sigma²), d the distance of p
// from the edge's line and sigma the slope of the radius. `weights` are those of the nearest ball on the
// whole plane: edges beyond which it lies are looked at, for from any other place the way there leads nearer.
NearestBall nearest_ball_on_edges(const Vector3d& p, const RoundedTriangle& t,
                                  const Vector3d& weights_on_plane) noexcept {
    NearestBall best;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t j = (i + 1) % 3;
        if (weights_on_plane[static_cast<Eigen::Index>((i + 2) % 3)] > 0) continue;
        const Vector3d edge = t.centres[j] - t.centres[i], way = p - t.centres[i];
        const double length = edge.norm();
        const double grows = t.radii[static_cast<Eigen::Index>(j)] - t.radii[static_cast<Eigen::Index>(i)];
        double share = grows > 0 ? 1 : 0;
        if (std::abs(grows) < length) {
            const double foot = way.dot(edge) / length, slope = grows / length;
            const double off = std::sqrt(std::max(0.0, way.squaredNorm() - foot * foot));
            share = std::clamp((foot + off * slope / std::sqrt(1 - slope * slope)) / length, 0.0, 1.0);
        }
        Vector3d weights = Vector3d::Zero();
        weights[static_cast<Eigen::Index>(i)] = 1 - share;
        weights[static_cast<Eigen::Index>(j)] = share;
        const NearestBall here =
            ball_at(p, t, weights, share > 0 && share < 1 ? Feature::edge : Feature::vertex);
        if (here.distance - here.radius >= least) continue;
        least = here.distance - here.radius;
        best = here;
    }
    return best;
}

}  // namespace

// On the face it lies off the foot of p by h gamma / sqrt(1 - gamma²), h the height of p over the plane and
// gamma the slope of the radius, a vector in it. |p - q| - rho(q) is convex: elsewhere it lies on an edge.
NearestBall nearest_ball(const Vector3d& p, const RoundedTriangle& t) noexcept {
    const Vector3d b = t.centres[1] - t.centres[0], c = t.centres[2] - t.centres[0], way = p - t.centres[0];
    const double bb = b.squaredNorm(), bc = b.dot(c), cc = c.squaredNorm();
    const double determinant = bb * cc - bc * bc;
    Vector3d weights = Vector3d::Zero();
    // Relative to the edges, as unit_normal() has it, squared.
    if (determinant > 1e-12 * bb * cc) {
        const double along_b = way.dot(b), along_c = way.dot(c);
        const double grows_b = t.radii[1] - t.radii[0], grows_c = t.radii[2] - t.radii[0];
        const double slope_b = (cc * grows_b - bc * grows_c) / determinant;
        const double slope_c = (bb * grows_c - bc * grows_b) / determinant;
        const double slope_squared = slope_b * grows_b + slope_c * grows_c;
        if (slope_squared < 1) {
            const double foot_b = (cc * along_b - bc * along_c) / determinant;
            const double foot_c = (bb * along_c - bc * along_b) / determinant;
            const double height_squared = way.squaredNorm() - foot_b * along_b - foot_c * along_c;
            const double off = std::sqrt(std::max(0.0, height_squared) / (1 - slope_squared));
            const double weight_b = foot_b + off * slope_b, weight_c = foot_c + off * slope_c;
            weights = {1 - weight_b - weight_c, weight_b, weight_c};
            if (weights.minCoeff() > 0) return ball_at(p, t, weights, Feature::face);
        }
    }
    return nearest_ball_on_edges(p, t, weights);
}

}  // namespace palpate::collision
