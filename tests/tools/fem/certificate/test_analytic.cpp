// SPDX-License-Identifier: GPL-3.0-or-later
// Linear tetrahedra against exact solutions of linear elasticity.
#include <Eigen/Geometry>
#include <gtest/gtest.h>

#include "tests/tools/fem/blocks.hpp"

namespace palpate {
namespace {

// A bar stretched by an end load, free to contract: u(L) = F L / (E A), exact for linear elements.
TEST(LinearTetrahedra, stretch_a_bar_as_hookes_law_says) {
    const double E = 5e-3, nu = 0.3, L = 10, side = 2, F = 1e-3;
    auto body = test::held_block({2, 2, 5}, {side, side, L}, {.youngs_modulus = E, .poissons_ratio = nu});
    const auto n = static_cast<Eigen::Index>(3 * body.mesh.rest_positions.size());
    // The exact field is imposed at the base, so that it may contract; tractions F/A act at the top.
    const double strain = F / (E * side * side);
    Eigen::VectorXd prescribed = Eigen::VectorXd::Zero(n), force = Eigen::VectorXd::Zero(n);
    for (const std::int32_t node : body.fixed_nodes) {
        const auto& p = body.mesh.rest_positions[static_cast<std::size_t>(node)];
        prescribed.segment<3>(3 * node) = Eigen::Vector3d(-nu * strain * p.x(), -nu * strain * p.y(), 0);
    }
    const BoundarySurface boundary = boundary_surface(body.mesh);
    for (const Triangle& t : boundary.surface.triangles) {
        const auto at = [&](std::size_t c) {
            return boundary.surface.vertices[static_cast<std::size_t>(t[c])];
        };
        if (at(0).z() < L - 1e-9 || at(1).z() < L - 1e-9 || at(2).z() < L - 1e-9) continue;
        const double area = (at(1) - at(0)).cross(at(2) - at(0)).norm() / 2;
        for (const std::int32_t v : t)
            force[3 * boundary.nodes[static_cast<std::size_t>(v)] + 2] += F / (side * side) * area / 3;
    }
    const Eigen::VectorXd u = test::solve_dense(body, body.fixed_nodes, prescribed, force);
    for (const std::int32_t node :
         test::nodes_where(body.mesh, [&](const Eigen::Vector3d& p) { return p.z() > L - 1e-9; }))
        EXPECT_NEAR(u[3 * node + 2], F * L / (E * side * side), 1e-10 * L);
}

}  // namespace
}  // namespace palpate
