// SPDX-License-Identifier: GPL-3.0-or-later
// Lamé's hollow sphere, and the orders at which both elements converge to it.
#include "tests/tools/fem/analytic/element_orders.hpp"
#include "tests/tools/fem/analytic/error_norms.hpp"
#include "tests/tools/fem/analytic/record.hpp"
#include "tests/tools/fem/blocks.hpp"
#include "tests/tools/fem/shapes.hpp"

namespace palpate::test {
namespace {

class LameSphere : public PerElementOrder {};
INSTANTIATE_TEST_SUITE_P(Both, LameSphere, element_orders(), order_name);

const Material material{.youngs_modulus = 6e-3, .poissons_ratio = 0.3};
constexpr double inner = 1, outer = 2, pressure = 1e-3;  // mm, mm, N/mm²

// The sphere's field in a block cut out of the shell, imposed on the block's flat faces: no error but the
// element's. Elements of degree p converge with order p in energy and p + 1 in displacement (Strang & Fix, An
// Analysis of the Finite Element Method, 1973, theorem 3.7). Between two meshes of finite size the order is
// met to 0.15.
TEST_P(LameSphere, in_a_block_converges_with_the_elements_full_order) {
    const int degree = static_cast<int>(GetParam());
    const ExactField field = lame_sphere(material, inner, outer, pressure);
    const auto errors_at = [&](int cells) {
        TetMesh mesh = block_mesh({cells, cells, cells}, {1, 1, 1});
        jitter_interior(mesh, 0.15 / cells, 3);  // a regular mesh would converge faster than theory promises
        for (Eigen::Vector3d& p : mesh.rest_positions) p += Eigen::Vector3d(0.6, 0.5, 0.4);
        const ElasticSystem system = elastic_system(mesh, material, GetParam());
        Supports supports(system);
        const auto on_face = [](const Eigen::Vector3d& p) {
            const Eigen::Array3d q = p.array() - Eigen::Array3d(0.6, 0.5, 0.4);
            return q.minCoeff() < 1e-9 || q.maxCoeff() > 1 - 1e-9;
        };
        supports.impose(system, on_face, field.displacement);
        return errors_against(system, solve(system, supports), field);
    };
    const int coarsest = GetParam() == ElementOrder::linear ? 4 : 2;
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
TEST_P(LameSphere, under_pressure_converges_with_the_order_of_flat_facets) {
    const ExactField field = lame_sphere(material, inner, outer, pressure);
    const auto error_at = [&](int around) {
        const ElasticSystem system =
            elastic_system(hollow_sphere_octant(inner, outer, around, around), material, GetParam());
        Supports supports(system);
        for (int axis = 0; axis < 3; ++axis)
            supports.hold(system, axis, [&](const Eigen::Vector3d& p) { return std::abs(p[axis]) < 1e-9; });
        const auto within = [](const Eigen::Vector3d& p) { return p.norm() < inner + 1e-9; };
        const Eigen::VectorXd u = solve(system, supports, pressure_forces(system, within, pressure));
        return errors_against(system, u, field).displacement;
    };
    const double coarse = error_at(4), middle = error_at(8),
                 fine = error_at(GetParam() == ElementOrder::linear ? 16 : 12);
    record("displacement errors", {coarse, middle, fine});
    const double refinement = GetParam() == ElementOrder::linear ? 2 : 1.5;
    EXPECT_GT(order_of(coarse, middle, 2), 1.7);
    EXPECT_GT(order_of(middle, fine, refinement), 1.8);
    // The facets' order is an upper bound for quadratic elements on such meshes too, whose own order is 3.
    EXPECT_LT(order_of(middle, fine, refinement), 2.2);
}

}  // namespace
}  // namespace palpate::test
