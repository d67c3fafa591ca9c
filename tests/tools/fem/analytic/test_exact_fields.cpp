// SPDX-License-Identifier: GPL-3.0-or-later
// The judges judged: each exact field meets equilibrium and its boundary loads, by differences of the field
// itself.
#include <gtest/gtest.h>

#include "tests/tools/fem/analytic/exact_fields.hpp"

namespace palpate::test {
namespace {

const Material field_material{.youngs_modulus = 2, .poissons_ratio = 0.3};

// Central differences over 1e-3 of fields of order one and their derivatives: 1e-6 truncation, 1e-7 round-off
// of second differences.
constexpr double step = 1e-3, difference_tolerance = 1e-5;

Eigen::Matrix3d difference(const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& u,
                           const Eigen::Vector3d& x) {
    Eigen::Matrix3d gradient;
    for (int j = 0; j < 3; ++j) {
        const Eigen::Vector3d h = step * Eigen::Vector3d::Unit(j);
        gradient.col(j) = (u(x + h) - u(x - h)) / (2 * step);
    }
    return gradient;
}

Eigen::Matrix3d stress(const Eigen::Matrix3d& gradient) {
    const double nu = field_material.poissons_ratio, E = field_material.youngs_modulus;
    const Eigen::Matrix3d strain = (gradient + gradient.transpose()) / 2;
    return E / (1 + nu) * (strain + nu / (1 - 2 * nu) * strain.trace() * Eigen::Matrix3d::Identity());
}

// The force per volume that a field needs to be in equilibrium.
Eigen::Vector3d needed_force(const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& u,
                             const Eigen::Vector3d& x) {
    Eigen::Vector3d divergence = Eigen::Vector3d::Zero();
    for (int j = 0; j < 3; ++j) {
        const Eigen::Vector3d h = step * Eigen::Vector3d::Unit(j);
        divergence += (stress(difference(u, x + h)) - stress(difference(u, x - h))).col(j) / (2 * step);
    }
    return -divergence;
}

TEST(ExactFields, hollow_sphere_is_in_equilibrium_and_carries_its_pressure) {
    const double a = 1, b = 2, pressure = 0.7;
    const ExactField field = lame_sphere(field_material, a, b, pressure);
    const Eigen::Vector3d direction = Eigen::Vector3d(1, 2, -2) / 3;
    EXPECT_LT(needed_force(field.displacement, 1.5 * direction).norm(), difference_tolerance);
    EXPECT_LT((difference(field.displacement, 1.5 * direction) - field.gradient(1.5 * direction)).norm(),
              difference_tolerance);
    EXPECT_LT((stress(field.gradient(a * direction)) * direction + pressure * direction).norm(), 1e-14);
    EXPECT_LT((stress(field.gradient(b * direction)) * direction).norm(), 1e-14);
}

TEST(ExactFields, thick_tube_is_in_equilibrium_and_carries_its_pressure) {
    const double a = 3, b = 9, pressure = 1;
    const auto field = [&](const Eigen::Vector3d& x) {
        const double r = std::hypot(x.x(), x.y());
        return Eigen::Vector3d(lame_tube_radial(field_material, a, b, pressure, r) / r *
                               Eigen::Vector3d(x.x(), x.y(), 0));
    };
    const Eigen::Vector3d direction(0.6, 0.8, 0);
    EXPECT_LT(needed_force(field, 5 * direction).norm(), difference_tolerance);
    EXPECT_LT((stress(difference(field, a * direction)) * direction + pressure * direction).norm(),
              difference_tolerance);
    EXPECT_LT((stress(difference(field, b * direction)) * direction).norm(), difference_tolerance);
}

// MacNeal & Harder's own table, to its five digits.
TEST(ExactFields, thick_tube_gives_the_published_displacements) {
    const auto inner = [](double nu) {
        return lame_tube_radial({.youngs_modulus = 1000, .poissons_ratio = nu}, 3, 9, 1, 3);
    };
    EXPECT_NEAR(inner(0.49), 5.0399e-3, 5e-8);
    EXPECT_NEAR(inner(0.499), 5.0602e-3, 5e-8);
    EXPECT_NEAR(inner(0.4999), 5.0623e-3, 5e-8);
}

TEST(ExactFields, half_space_is_in_equilibrium_and_carries_one_newton) {
    const auto field = [](const Eigen::Vector3d& x) { return boussinesq(field_material, x); };
    EXPECT_LT(needed_force(field, {0.5, 0.7, -0.8}).norm(), difference_tolerance);
    // No traction on the surface, and every horizontal plane below passes the force on; the traction falls as
    // r^-5.
    EXPECT_LT((stress(difference(field, {1, 0.5, 0})).col(2)).norm(), difference_tolerance);
    double force = 0;
    const double dr = 0.01;
    for (double r = dr / 2; r < 30; r += dr)
        force -= stress(difference(field, {r, 0, -1}))(2, 2) * 2 * std::numbers::pi * r * dr;
    EXPECT_NEAR(force, 1, 1e-4);
}

TEST(ExactFields, hung_bar_carries_its_weight_and_is_free_at_its_sides) {
    const double weight = 0.4, length = 3;
    const auto field = [&](const Eigen::Vector3d& x) { return hung_bar(field_material, weight, length, x); };
    const Eigen::Vector3d at(0.2, -0.4, 1.7);
    EXPECT_LT((needed_force(field, at) - Eigen::Vector3d(0, 0, -weight)).norm(), difference_tolerance);
    Eigen::Matrix3d pulled = Eigen::Matrix3d::Zero();
    pulled(2, 2) = weight * at.z();
    EXPECT_LT((stress(difference(field, at)) - pulled).norm(), difference_tolerance);
    EXPECT_NEAR(-field({0, 0, 0}).z(), weight * length * length / (2 * field_material.youngs_modulus), 1e-14);
}

}  // namespace
}  // namespace palpate::test
