// SPDX-License-Identifier: GPL-3.0-or-later
// A rigid flat punch on a half-space, frictionless.
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "tests/tools/fem/analytic/exact_fields.hpp"
#include "tests/tools/fem/analytic/half_space.hpp"
#include "tests/tools/fem/analytic/record.hpp"

namespace palpate::test {
namespace {

const Material punch_material{.youngs_modulus = 6e-3, .poissons_ratio = 0.3};

// Force on a punch of radius a = 1 mm pressed 1 mm deep, over Boussinesq's F = 2 a E d / (1 - nu²) (Sneddon,
// Int. J. Eng. Sci. 3 (1965) 47-57). On a quarter of the half-space out to 8 a. Held at rest there, even a
// perfect mesh would be too stiff by about 1/8; so the far boundary moves as Boussinesq's point force of the
// very force F that the punch feels: F = F(d) + F F(lift), where F(lift) is what the far field of 1 N does to
// a resting punch. What is left is the difference between a disc and a point, of order 1/8³.
double resistance(ElementOrder order, int steps) {
    const ElasticSystem system = elastic_system(half_space_mesh(steps, 8, true), punch_material, order);
    const auto far = on_far_boundary(system.body.mesh);
    const auto force = [&](double depth, double far_force) {
        Supports supports(system);
        for (int axis = 0; axis < 2; ++axis)
            supports.hold(system, axis, [&](const Eigen::Vector3d& p) { return std::abs(p[axis]) < 1e-9; });
        supports.hold(system, 2, on_pressed_disc, -depth);
        supports.impose(system, far, [&](const Eigen::Vector3d& p) {
            return Eigen::Vector3d(far_force * boussinesq(punch_material, p));
        });
        const Eigen::VectorXd f = nodal_forces(system, solve(system, supports));
        double quarter = 0;
        for (std::size_t node = 0; node < system.positions.size(); ++node)
            if (on_pressed_disc(system.positions[node]))
                quarter -= f[static_cast<Eigen::Index>(3 * node + 2)];
        return 4 * quarter;
    };
    // The mesh's disc is a polygon, which resists as the disc of the same area (King, Int. J. Solids Struct.
    // 23 (1987) 1657-1664: even a square does to 1.2 %).
    const double corners = 8 * steps;
    const double radius =
        std::sqrt(corners / 2 * std::sin(2 * std::numbers::pi / corners) / std::numbers::pi);
    const double exact = 2 * radius * punch_material.youngs_modulus /
                         (1 - punch_material.poissons_ratio * punch_material.poissons_ratio);
    return force(1, 0) / (1 - force(0, 1)) / exact;
}

// Prescribed displacements: the force falls towards the exact one. The pressure's singularity at the rim
// costs O(h) with either element, so Richardson's extrapolation takes it out; with linear elements once more
// for O(h²). From meshes this coarse that is worth 2 % with linear and 1 % with quadratic elements.
TEST(LinearTetrahedra, resist_a_flat_punch_as_boussinesq_says) {
    const double coarse = resistance(ElementOrder::linear, 2), middle = resistance(ElementOrder::linear, 4),
                 fine = resistance(ElementOrder::linear, 8);
    record("force over Boussinesq's", {coarse, middle, fine});
    EXPECT_GT(coarse, middle);
    EXPECT_GT(middle, fine);
    EXPECT_GT(fine, 1);
    const double without_rim_coarse = 2 * middle - coarse, without_rim = 2 * fine - middle;
    EXPECT_NEAR((4 * without_rim - without_rim_coarse) / 3, 1, 0.02);
}

TEST(QuadraticTetrahedra, resist_a_flat_punch_as_boussinesq_says) {
    const double coarse = resistance(ElementOrder::quadratic, 2),
                 fine = resistance(ElementOrder::quadratic, 4);
    record("force over Boussinesq's", {coarse, fine});
    EXPECT_GT(coarse, fine);
    EXPECT_GT(fine, 1);
    EXPECT_LT(fine, 1.03);  // where linear elements of the same mesh are 12 % too stiff
    EXPECT_NEAR(2 * fine - coarse, 1, 0.01);
}

}  // namespace
}  // namespace palpate::test
