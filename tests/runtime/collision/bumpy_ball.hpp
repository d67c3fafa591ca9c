// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "tests/formats/sample_case.hpp"

namespace palpate {

/// A ball with bumps and hollows, so that distances have minima in many places.
inline TriangleMesh bumpy_ball(double radius, int refinements, double bump) {
    TriangleMesh mesh = sample::sphere_surface({0, 0, 0}, radius, refinements);
    for (Eigen::Vector3d& v : mesh.vertices)
        v *= 1 + bump * std::sin(0.9 * v.x()) * std::cos(1.1 * v.y()) * std::sin(0.7 * v.z() + 1);
    return mesh;
}

/// Turned at random, and so far away in a direction at random.
inline Eigen::Isometry3d any_placement(double away, std::mt19937& random) {
    std::normal_distribution<double> component(0, 1);
    Eigen::Isometry3d X_BA = Eigen::Isometry3d::Identity();
    X_BA.linear() =
        Eigen::Quaterniond(component(random), component(random), component(random), component(random))
            .normalized()
            .toRotationMatrix();
    X_BA.translation() =
        away * Eigen::Vector3d(component(random), component(random), component(random)).normalized();
    return X_BA;
}

}  // namespace palpate
