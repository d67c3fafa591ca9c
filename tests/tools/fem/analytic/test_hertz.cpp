// SPDX-License-Identifier: GPL-3.0-or-later
// A rigid sphere on a half-space, frictionless: unilateral contact on the condensed compliance.
#include <cmath>
#include <gtest/gtest.h>

#include "tests/tools/fem/analytic/exact_fields.hpp"
#include "tests/tools/fem/analytic/half_space.hpp"
#include "tests/tools/fem/analytic/record.hpp"
#include "tests/tools/fem/blocks.hpp"
#include "tests/tools/fem/compliances.hpp"
#include "tools/fem/condensation/condense.hpp"

namespace palpate::test {
namespace {

const Material material{.youngs_modulus = 6e-3, .poissons_ratio = 0.3};
constexpr double sphere_radius = 10;  // mm; contact radii of 0.5 to 0.95 mm are small against it

DeformableBody held_half_space(ElementOrder order, int steps) {
    DeformableBody body;
    body.name = "half-space";
    body.mesh = half_space_mesh(steps, 4, false);
    body.element_order = order;
    body.materials = {{1, material}};
    body.boundary = boundary_surface(body.mesh);
    body.fixed_nodes = nodes_where(body.mesh, on_far_boundary(body.mesh));
    body.contact_nodes = nodes_where(body.mesh, on_pressed_disc);
    return body;
}

// Downward displacements of the contact nodes (mm) for downward forces on them (N), as Palpate condenses
// them, and what the held far boundary suppresses added: it should move as under a point force of the forces'
// sum.
Eigen::MatrixXd condensed_normal_compliance(const DeformableBody& body) {
    const Eigen::MatrixXd C = full(fem::condense_by_trailing_block(body, no_progress));
    const auto m = static_cast<Eigen::Index>(body.contact_nodes.size());
    Eigen::MatrixXd A = C(Eigen::seqN(2, m, 3), Eigen::seqN(2, m, 3));
    const ElasticSystem system = elastic_system(body);
    Supports one_newton_far_off(system);
    one_newton_far_off.impose(system, on_far_boundary(body.mesh),
                              [](const Eigen::Vector3d& p) { return boussinesq(material, p); });
    const Eigen::VectorXd u = solve(system, one_newton_far_off);
    for (Eigen::Index k = 0; k < m; ++k)
        A.row(k).array() -= u[3 * body.contact_nodes[static_cast<std::size_t>(k)] + 2];
    return A;
}

// Forces f >= 0 (N) with gaps A f + g >= 0 and f . (A f + g) = 0, by projected Gauss-Seidel.
Eigen::VectorXd contact_forces(const Eigen::MatrixXd& A, const Eigen::VectorXd& g) {
    Eigen::VectorXd f = Eigen::VectorXd::Zero(g.size());
    for (int sweep = 0; sweep < 20000; ++sweep) {
        double change = 0;
        for (Eigen::Index i = 0; i < f.size(); ++i) {
            const double next = std::max(0.0, f[i] - (A.row(i).dot(f) + g[i]) / A(i, i));
            change = std::max(change, std::abs(next - f[i]));
            f[i] = next;
        }
        if (change < 1e-10 * f.maxCoeff()) return f;
    }
    ADD_FAILURE() << "projected Gauss-Seidel did not settle";
    return f;
}

struct HertzFit {
    double exponent;           // of the depth, by least squares in logarithms
    double smallest, largest;  // force over Hertz's
};

// Hertz: F = 4/3 E / (1 - nu²) sqrt(R) d^1.5 and contact radius sqrt(R d), for the paraboloid r² / (2 R) that
// stands for the sphere (Johnson, Contact Mechanics (1985), eqs. 4.22-4.24).
HertzFit press_sphere(const DeformableBody& body, const Eigen::MatrixXd& A) {
    std::vector<double> x, y;
    HertzFit fit{0, 1e9, 0};
    for (double contact_radius = 0.5; contact_radius < 0.96; contact_radius += 0.05) {
        const double depth = contact_radius * contact_radius / sphere_radius;
        Eigen::VectorXd gap(A.rows());
        for (Eigen::Index k = 0; k < gap.size(); ++k)
            gap[k] = body.mesh
                             .rest_positions[static_cast<std::size_t>(
                                 body.contact_nodes[static_cast<std::size_t>(k)])]
                             .squaredNorm() /
                         (2 * sphere_radius) -
                     depth;
        const double force = contact_forces(A, gap).sum();
        const double hertz = 4.0 / 3 * material.youngs_modulus / (1 - std::pow(material.poissons_ratio, 2)) *
                             std::sqrt(sphere_radius) * std::pow(depth, 1.5);
        fit.smallest = std::min(fit.smallest, force / hertz);
        fit.largest = std::max(fit.largest, force / hertz);
        x.push_back(std::log(depth));
        y.push_back(std::log(force));
    }
    const auto n = static_cast<Eigen::Index>(x.size());
    const Eigen::ArrayXd X = Eigen::Map<Eigen::ArrayXd>(x.data(), n),
                         Y = Eigen::Map<Eigen::ArrayXd>(y.data(), n);
    fit.exponent = ((X - X.mean()) * (Y - Y.mean())).sum() / (X - X.mean()).square().sum();
    return fit;
}

// The contact radius spans 3 to 5.7 nodes. It grows by whole nodes, so the force wavers about its power law:
// 5 % and 0.03 in the exponent.
TEST(LinearTetrahedra, resist_a_sphere_as_hertz_says) {
    const DeformableBody body = held_half_space(ElementOrder::linear, 6);
    const HertzFit fit = press_sphere(body, condensed_normal_compliance(body));
    record("smallest and largest force over Hertz's, exponent", {fit.smallest, fit.largest, fit.exponent});
    EXPECT_GT(fit.smallest, 0.98);
    EXPECT_LT(fit.largest, 1.05);
    EXPECT_NEAR(fit.exponent, 1.5, 0.03);
}

// A quadratic body's compliance knows forces and gaps at corners only. Such point forces dent the surface
// between corners, whose middles then lie inside the tool: at 2 to 4 elements a contact radius the body feels
// 13 to 21 % too soft, though the element itself is far better than the linear one (the flat punch, whose
// tool holds the middles too). The error falls with the element's size over the contact radius.
TEST(QuadraticTetrahedra, give_way_to_a_sphere_too_easily_where_only_corners_carry) {
    const DeformableBody body = held_half_space(ElementOrder::quadratic, 4);
    const HertzFit fit = press_sphere(body, condensed_normal_compliance(body));
    record("smallest and largest force over Hertz's, exponent", {fit.smallest, fit.largest, fit.exponent});
    EXPECT_GT(fit.smallest, 0.77);
    EXPECT_LT(fit.largest, 0.88);
}

}  // namespace
}  // namespace palpate::test
