// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/fem/analytic/half_space.hpp"

#include <cmath>
#include <numbers>

#include "tests/tools/fem/shapes.hpp"

namespace palpate::test {

TetMesh half_space_mesh(int steps, double end, bool quarter) {
    std::vector<double> distances;
    for (int i = 0; i <= steps; ++i) distances.push_back(double(i) / steps);
    while (distances.back() < end) distances.push_back(distances.back() * (1 + 1.0 / steps));
    const PlaneMesh disc = quarter ? cut_disc(distances, 2, std::numbers::pi / 2, steps)
                                   : cut_disc(distances, 6, 2 * std::numbers::pi, steps);
    return sweep(disc, static_cast<int>(distances.size()) - 1, [&](const Eigen::Vector2d& p, int border) {
        return Eigen::Vector3d(p.x(), p.y(), -distances[static_cast<std::size_t>(border)]);
    });
}

Condition on_far_boundary(const TetMesh& mesh) {
    double depth = 0;  // and radius
    for (const Eigen::Vector3d& p : mesh.rest_positions) depth = std::max(depth, -p.z());
    return [depth](const Eigen::Vector3d& p) {
        // Middles of the outer ring's chords lie inside it.
        return p.z() < -depth * (1 - 1e-9) || std::hypot(p.x(), p.y()) > depth * 0.98;
    };
}

bool on_pressed_disc(const Eigen::Vector3d& p) {
    return p.z() > -1e-9 && std::hypot(p.x(), p.y()) < 1 + 1e-9;
}

}  // namespace palpate::test
