// SPDX-License-Identifier: GPL-3.0-or-later
// MacNeal & Harder's nearly incompressible thick tube: how much of the exact displacement each element
// reaches.
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>

#include "tests/tools/fem/analytic/elastic_system.hpp"
#include "tests/tools/fem/analytic/exact_fields.hpp"
#include "tests/tools/fem/analytic/record.hpp"
#include "tests/tools/fem/shapes.hpp"

namespace palpate::test {
namespace {

// Mean radial displacement of the inner face over the exact one: inner radius 3, outer 9, E = 1000, p = 1,
// plane strain (Finite Elem. Anal. Des. 1 (1985) 3-20).
double reached(double poissons_ratio, ElementOrder order, int around) {
    const Material material{.youngs_modulus = 1000, .poissons_ratio = poissons_ratio};
    const ElasticSystem system =
        elastic_system(tube_quarter(3, 9, 6.0 / around, around, around), material, order);
    Supports supports(system);
    supports.hold(system, 0, [](const Eigen::Vector3d& p) { return p.x() < 1e-9; });
    supports.hold(system, 1, [](const Eigen::Vector3d& p) { return p.y() < 1e-9; });
    supports.hold(system, 2, [](const Eigen::Vector3d&) { return true; });
    const auto within = [](const Eigen::Vector3d& p) { return std::hypot(p.x(), p.y()) < 3 + 1e-9; };
    const Eigen::VectorXd u = solve(system, supports, pressure_forces(system, within, 1));
    double sum = 0;
    int count = 0;
    for (std::size_t node = 0; node < system.body.mesh.rest_positions.size(); ++node)
        if (const Eigen::Vector3d& p = system.positions[node]; within(p)) {
            sum += u.segment<3>(static_cast<Eigen::Index>(3 * node)).dot(p) / 3;
            ++count;
        }
    return sum / count / lame_tube_radial(material, 3, 9, 1, 3);
}

constexpr std::array<double, 5> poissons_ratios{0.3, 0.45, 0.49, 0.499, 0.4999};

std::vector<double> reached_at_each_ratio(ElementOrder order, int around) {
    std::vector<double> ratios;
    for (const double nu : poissons_ratios) ratios.push_back(reached(nu, order, around));
    record("around " + std::to_string(around) + ", nu 0.3 0.45 0.49 0.499 0.4999", ratios);
    return ratios;
}

TEST(LinearTetrahedra, lock_as_poissons_ratio_nears_one_half) {
    const auto coarse = reached_at_each_ratio(ElementOrder::linear, 8),
               fine = reached_at_each_ratio(ElementOrder::linear, 16);
    EXPECT_TRUE(std::ranges::is_sorted(fine, std::greater<>()));
    EXPECT_GT(fine.front(), 0.99);
    EXPECT_LT(fine.back(), 0.85);
    // Refinement takes three quarters of the error away at 0.3 and next to nothing of it at 0.4999.
    EXPECT_LT(1 - fine.front(), 0.3 * (1 - coarse.front()));
    EXPECT_GT(1 - fine.back(), 0.9 * (1 - coarse.back()));
}

// What is missing is the flat facets' share of order h², much the same at every Poisson's ratio.
TEST(QuadraticTetrahedra, do_not_lock_as_poissons_ratio_nears_one_half) {
    const auto coarse = reached_at_each_ratio(ElementOrder::quadratic, 8),
               fine = reached_at_each_ratio(ElementOrder::quadratic, 16);
    for (std::size_t i = 0; i < fine.size(); ++i) {
        EXPECT_NEAR(coarse[i], 1, 0.007) << "nu " << poissons_ratios[i];
        EXPECT_NEAR(fine[i], 1, 0.002) << "nu " << poissons_ratios[i];
    }
}

}  // namespace
}  // namespace palpate::test
