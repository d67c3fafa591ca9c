// SPDX-License-Identifier: GPL-3.0-or-later
// Lamé's hollow sphere, and the orders at which both elements converge to it.
#include <gtest/gtest.h>

#include "tests/tools/fem/analytic/error_norms.hpp"
#include "tests/tools/fem/analytic/record.hpp"
#include "tests/tools/fem/blocks.hpp"
#include "tests/tools/fem/shapes.hpp"

namespace palpate::test {
namespace {

const Material shell_material{.youngs_modulus = 6e-3, .poissons_ratio = 0.3};
constexpr double inner = 1, outer = 2, pressure = 1e-3;  // mm, mm, N/mm²

// The sphere's field in a block cut out of the shell, imposed on the block's flat faces: no error but the
// element's. Elements of degree p converge with order p in energy and p + 1 in displacement (Strang & Fix, An
// Analysis of the Finite Element Method, 1973, chapter 3). Meshes of finite size come within 0.25 of it,
// finer ones within 0.15.
void expect_full_order_in_a_block(ElementOrder order) {
    const int degree = static_cast<int>(order);
    const ExactField field = lame_sphere(shell_material, inner, outer, pressure);
    const auto errors_at = [&](int cells) {
        TetMesh mesh = block_mesh({cells, cells, cells}, {1, 1, 1});
        jitter_interior(mesh, 0.15 / cells, 3);  // a regular mesh would converge faster than theory promises
        for (Eigen::Vector3d& p : mesh.rest_positions) p += Eigen::Vector3d(0.6, 0.5, 0.4);
        const ElasticSystem system = elastic_system(mesh, shell_material, order);
        Supports supports(system);
        const auto on_face = [](const Eigen::Vector3d& p) {
            const Eigen::Array3d q = p.array() - Eigen::Array3d(0.6, 0.5, 0.4);
            return q.minCoeff() < 1e-9 || q.maxCoeff() > 1 - 1e-9;
        };
        supports.impose(system, on_face, field.displacement);
        return errors_against(system, solve(system, supports), field);
    };
    const int coarsest = order == ElementOrder::linear ? 4 : 2;
    const RelativeErrors coarse = errors_at(coarsest), middle = errors_at(2 * coarsest),
                         fine = errors_at(4 * coarsest);
    record("energy errors", {coarse.energy, middle.energy, fine.energy});
    record("displacement errors", {coarse.displacement, middle.displacement, fine.displacement});
    EXPECT_GT(order_of(middle.energy, fine.energy, 2), degree - 0.15);
    EXPECT_GT(order_of(middle.displacement, fine.displacement, 2), degree + 1 - 0.15);
    EXPECT_GT(order_of(coarse.energy, middle.energy, 2), degree - 0.25);
    EXPECT_GT(order_of(coarse.displacement, middle.displacement, 2), degree + 1 - 0.25);
}

// An octant of the shell, sliding on its three planes of symmetry. Its flat facets miss the spheres by O(h²),
// and so do the displacements of either element: straight-sided quadratic elements gain accuracy on a curved
// body, not order.
void expect_the_order_of_flat_facets_under_pressure(ElementOrder order) {
    const ExactField field = lame_sphere(shell_material, inner, outer, pressure);
    const auto error_at = [&](int around) {
        const ElasticSystem system =
            elastic_system(hollow_sphere_octant(inner, outer, around, around), shell_material, order);
        Supports supports(system);
        for (int axis = 0; axis < 3; ++axis)
            supports.hold(system, axis, [&](const Eigen::Vector3d& p) { return std::abs(p[axis]) < 1e-9; });
        const auto within = [](const Eigen::Vector3d& p) { return p.norm() < inner + 1e-9; };
        const Eigen::VectorXd u = solve(system, supports, pressure_forces(system, within, pressure));
        return errors_against(system, u, field).displacement;
    };
    const double coarse = error_at(4), middle = error_at(8),
                 fine = error_at(order == ElementOrder::linear ? 16 : 12);
    record("displacement errors", {coarse, middle, fine});
    const double refinement = order == ElementOrder::linear ? 2 : 1.5;
    EXPECT_GT(order_of(coarse, middle, 2), 1.7);
    EXPECT_GT(order_of(middle, fine, refinement), 1.8);
    // Quadratic elements' own order would be 3.
    EXPECT_LT(order_of(middle, fine, refinement), 2.2);
}

TEST(LinearTetrahedra, converge_to_lames_sphere_with_full_order) {
    expect_full_order_in_a_block(ElementOrder::linear);
}
TEST(QuadraticTetrahedra, converge_to_lames_sphere_with_full_order) {
    expect_full_order_in_a_block(ElementOrder::quadratic);
}
TEST(LinearTetrahedra, converge_to_lames_sphere_under_pressure_as_flat_facets_do) {
    expect_the_order_of_flat_facets_under_pressure(ElementOrder::linear);
}
TEST(QuadraticTetrahedra, converge_to_lames_sphere_under_pressure_as_flat_facets_do) {
    expect_the_order_of_flat_facets_under_pressure(ElementOrder::quadratic);
}

}  // namespace
}  // namespace palpate::test
