// SPDX-License-Identifier: GPL-3.0-or-later
// Bars: hung by their own weight, bent by an end load.
#include <gtest/gtest.h>

#include "tests/tools/fem/analytic/error_norms.hpp"
#include "tests/tools/fem/analytic/record.hpp"
#include "tests/tools/fem/blocks.hpp"

namespace palpate::test {
namespace {

const Material bar_material{.youngs_modulus = 6e-3, .poissons_ratio = 0.3};

// The field is quadratic in the coordinates, so quadratic elements hold it at every node, and its end at
// u(L) = w L² / (2 E); 1e-11 allows a condition number of 1e4.
TEST(QuadraticTetrahedra, hang_a_bar_by_its_own_weight_to_round_off) {
    const double length = 4, weight = 1e-5;  // mm, N/mm³ (water)
    TetMesh mesh = block_mesh({2, 2, 8}, {1, 1, length});
    jitter_interior(mesh, 0.08, 5);
    const ElasticSystem system = elastic_system(mesh, bar_material, ElementOrder::quadratic);
    const auto field = [&](const Eigen::Vector3d& x) { return hung_bar(bar_material, weight, length, x); };
    Supports supports(system);
    supports.impose(
        system, [&](const Eigen::Vector3d& p) { return p.z() > length - 1e-9; }, field);
    const Eigen::VectorXd u = solve(system, supports, body_forces(system, {0, 0, -weight}));
    const double elongation = weight * length * length / (2 * bar_material.youngs_modulus);
    for (std::size_t node = 0; node < system.positions.size(); ++node)
        EXPECT_LT((u.segment<3>(static_cast<Eigen::Index>(3 * node)) - field(system.positions[node])).norm(),
                  1e-11 * elongation);
}

// A cantilever of length L and square section h² under the end load F deflects by F L³ / (3 E I) + F L /
// (kappa G A) (Timoshenko), kappa = 10 (1 + nu) / (12 + 11 nu) (Cowper, J. Appl. Mech. 33 (1966) 335,
// rectangle).
double cantilever_ratio(ElementOrder order, int cells) {
    const double L = 10, h = 1, F = 1e-5, E = bar_material.youngs_modulus, nu = bar_material.poissons_ratio;
    const ElasticSystem system =
        elastic_system(block_mesh({cells, cells, 5 * cells}, {h, h, L}), bar_material, order);
    Supports supports(system);
    supports.impose(
        system, [](const Eigen::Vector3d& p) { return p.z() < 1e-9; },
        [](const Eigen::Vector3d&) { return Eigen::Vector3d(0, 0, 0); });
    const auto at_end = [&](const Eigen::Vector3d& p) { return p.z() > L - 1e-9; };
    const Eigen::VectorXd forces = traction_forces(system, at_end, {F / (h * h), 0, 0});
    const Eigen::VectorXd u = solve(system, supports, forces);
    const double deflection = u.dot(forces) / F;  // mean over the end face
    const double kappa = 10 * (1 + nu) / (12 + 11 * nu), G = E / (2 * (1 + nu));
    const double timoshenko = F * L * L * L / (3 * E * h * h * h * h / 12) + F * L / (kappa * G * h * h);
    return deflection / timoshenko;
}

// A clamp that forbids the section to contract stiffens a region of about h near it, and Timoshenko's formula
// leaves that out: well below h / L of the deflection.
TEST(QuadraticTetrahedra, bend_a_cantilever_as_timoshenko_says) {
    const double coarse = cantilever_ratio(ElementOrder::quadratic, 1),
                 middle = cantilever_ratio(ElementOrder::quadratic, 2),
                 fine = cantilever_ratio(ElementOrder::quadratic, 4);
    record("deflection over Timoshenko's", {coarse, middle, fine});
    EXPECT_NEAR(coarse, 1, 0.05);  // one element across
    EXPECT_NEAR(fine, 1, 0.01);
    EXPECT_LT(coarse, middle);  // prescribed supports and loads: stiffness from above, deflection from below
    EXPECT_LT(middle, fine);
}

// With as many nodes across the section (8 cells against 4) they reach 0.88 of it where quadratic ones reach
// 0.99.
TEST(LinearTetrahedra, bend_a_cantilever_too_little_and_better_with_every_refinement) {
    const double one = cantilever_ratio(ElementOrder::linear, 1),
                 two = cantilever_ratio(ElementOrder::linear, 2),
                 four = cantilever_ratio(ElementOrder::linear, 4),
                 eight = cantilever_ratio(ElementOrder::linear, 8);
    record("deflection over Timoshenko's", {one, two, four, eight});
    EXPECT_LT(one, 0.2);
    EXPECT_LT(one, two);
    EXPECT_LT(two, four);
    EXPECT_LT(four, eight);
    EXPECT_LT(eight, 1);
    EXPECT_GT(order_of(1 - four, 1 - eight, 2), 1.4);  // on its way to 2
}

}  // namespace
}  // namespace palpate::test
