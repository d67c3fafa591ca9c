// SPDX-License-Identifier: GPL-3.0-or-later
// What the spaces of linear and quadratic displacements contain: fields that they reproduce, and each other.
#include <Eigen/Eigenvalues>
#include <gtest/gtest.h>

#include "formats/elasticity/stiffness.hpp"
#include "tests/tools/fem/blocks.hpp"
#include "tests/tools/fem/compliances.hpp"
#include "tools/fem/assembly/refinement.hpp"
#include "tools/fem/certificate/certificate.hpp"
#include "tools/fem/condensation/condense.hpp"

namespace palpate {
namespace {

using namespace fem;

const Material soft_tissue{.youngs_modulus = 6e-3, .poissons_ratio = 0.45};

// Dense solves of a few hundred unknowns whose stiffness has a condition of 1e3 or so.
constexpr double space_solve_tolerance = 1e-12;
// Sums of a few dozen products keep 13 digits.
constexpr double space_round_off = 1e-13;

using test::no_progress;

DeformableBody two_material_block(ElementOrder order) {
    auto body = test::held_block({3, 2, 2}, {6, 4, 4}, soft_tissue);
    test::jitter_interior(body.mesh, 0.3, 3);
    body.element_order = order;
    for (std::size_t t = 20; t < 30; ++t) body.mesh.regions[t] = 2;
    body.materials.push_back({2, {.youngs_modulus = 30e-3, .poissons_ratio = 0.3}});
    return body;
}

// Imposes the field on the whole boundary and returns the largest error inside, relative to the field.
double error_inside(const DeformableBody& body,
                    const std::function<Eigen::Vector3d(const Eigen::Vector3d&)>& field) {
    const Eigen::VectorXd exact = test::sampled(body, field);
    const Eigen::VectorXd u =
        test::solve_dense(body, test::boundary_nodes(body), exact, Eigen::VectorXd::Zero(exact.size()));
    return (u - exact).cwiseAbs().maxCoeff() / exact.cwiseAbs().maxCoeff();
}

Eigen::Vector3d macneal_harder_field(const Eigen::Vector3d& p) {
    return 0.5e-3 *
           Eigen::Vector3d(2 * p.x() + p.y() + p.z(), p.x() + 2 * p.y() + p.z(), p.x() + p.y() + 2 * p.z());
}

// MacNeal & Harder 1985, solid patch test: a linear field on the boundary is reproduced at the published
// inner nodes, with normal stresses 2000 and shear stresses 400, so an energy of (3 * 2000 + 3 * 400) 1e-3
// / 2.
void expect_patch_test_passed(ElementOrder order) {
    DeformableBody body;
    body.mesh = test::macneal_harder_cube();
    body.materials = {{1, {.youngs_modulus = 1e6, .poissons_ratio = 0.25}}};
    body.element_order = order;
    ASSERT_EQ(body.mesh.tetrahedra.size(), 7U * 6U);
    EXPECT_LT(error_inside(body, macneal_harder_field), space_solve_tolerance);
    const Eigen::VectorXd u = test::sampled(body, macneal_harder_field);
    EXPECT_NEAR(0.5 * u.dot(test::full_stiffness(body) * u), 3.6, 3.6 * space_solve_tolerance);
}

TEST(LinearTetrahedra, pass_the_published_patch_test_to_round_off) {
    expect_patch_test_passed(ElementOrder::linear);
}

TEST(QuadraticTetrahedra, pass_the_published_patch_test_to_round_off) {
    expect_patch_test_passed(ElementOrder::quadratic);
}

// Pure bending, sigma_xx = E y and nothing else, in equilibrium without body forces.
TEST(QuadraticTetrahedra, reproduce_pure_bending_which_linear_ones_cannot) {
    const double nu = soft_tissue.poissons_ratio;
    const auto bending = [&](const Eigen::Vector3d& p) {
        return Eigen::Vector3d(p.x() * p.y(), -(p.x() * p.x() + nu * (p.y() * p.y() - p.z() * p.z())) / 2,
                               -nu * p.y() * p.z());
    };
    auto body = test::held_block({3, 3, 2}, {3, 3, 2}, soft_tissue);
    test::jitter_interior(body.mesh, 0.2, 4);
    EXPECT_GT(error_inside(body, bending), 1e-3);
    body.element_order = ElementOrder::quadratic;
    EXPECT_LT(error_inside(body, bending), space_solve_tolerance);
}

// Over the unit cube, by hand: u = (x², 0, 0) stores 2/3 (lambda + 2 mu), and torsion (-yz, xz, 0) mu / 3.
TEST(QuadraticTetrahedra, store_the_energy_of_quadratic_fields_that_a_hand_calculation_gives) {
    auto body = test::held_block({2, 2, 2}, {1, 1, 1}, soft_tissue);
    test::jitter_interior(body.mesh, 0.1, 5);
    body.element_order = ElementOrder::quadratic;
    const double lambda = soft_tissue.youngs_modulus * 0.45 / (1.45 * 0.1),
                 mu = soft_tissue.youngs_modulus / 2.9;
    const Eigen::MatrixXd K = test::full_stiffness(body);
    const auto energy = [&](const auto& field) {
        const Eigen::VectorXd u = test::sampled(body, field);
        return 0.5 * u.dot(K * u);
    };
    EXPECT_NEAR(energy([](const Eigen::Vector3d& p) { return Eigen::Vector3d(p.x() * p.x(), 0, 0); }),
                (lambda + 2 * mu) * 2 / 3, space_round_off);
    EXPECT_NEAR(
        energy([](const Eigen::Vector3d& p) { return Eigen::Vector3d(-p.y() * p.z(), p.x() * p.z(), 0); }),
        mu / 3, space_round_off);
}

// Displacements of the mesh nodes, taken to the middles of edges as the mean of both ends.
Eigen::MatrixXd interpolation_to_middles(const DeformableBody& body) {
    const elasticity::Discretisation d = elasticity::discretise(body.mesh, ElementOrder::quadratic, {});
    const auto corners = static_cast<Eigen::Index>(3 * body.mesh.rest_positions.size());
    Eigen::MatrixXd P = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(3 * d.node_count), corners);
    P.topRows(corners).setIdentity();
    for (std::size_t e = 0; e < d.edges.size(); ++e)
        for (const std::int32_t end : d.edges[e])
            P.block<3, 3>(corners + static_cast<Eigen::Index>(3 * e), 3 * end).diagonal().setConstant(0.5);
    return P;
}

TEST(LinearTetrahedra, are_contained_in_quadratic_ones_and_in_the_refined_mesh) {
    const DeformableBody linear = two_material_block(ElementOrder::linear);
    DeformableBody quadratic = linear, refined = linear;
    quadratic.element_order = ElementOrder::quadratic;
    refined.mesh = refine_uniformly(linear.mesh);
    const Eigen::MatrixXd K = test::full_stiffness(linear), P = interpolation_to_middles(linear);
    EXPECT_LT((P.transpose() * test::full_stiffness(quadratic) * P - K).cwiseAbs().maxCoeff(),
              space_round_off);
    EXPECT_LT((P.transpose() * test::full_stiffness(refined) * P - K).cwiseAbs().maxCoeff(), space_round_off);
}

// A larger space is never stiffer: for every load f on the surface, f C f does not fall.
TEST(LinearTetrahedra, are_never_softer_than_quadratic_ones_or_the_refined_mesh) {
    DeformableBody body = two_material_block(ElementOrder::linear);
    std::ranges::set_difference(boundary_surface(body.mesh).nodes, body.fixed_nodes,
                                std::back_inserter(body.contact_nodes));
    const auto compliance = [](const DeformableBody& of) {
        return test::full(condense_by_trailing_block(of, no_progress));
    };
    DeformableBody quadratic = body, refined = body;
    quadratic.element_order = ElementOrder::quadratic;
    refined.fixed_nodes = elasticity::discretise(quadratic).fixed_nodes;
    refined.mesh = refine_uniformly(body.mesh);
    const Eigen::MatrixXd C = compliance(body);
    for (const DeformableBody& larger : {quadratic, refined}) {
        const Eigen::VectorXd gain =
            Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(compliance(larger) - C).eigenvalues();
        EXPECT_GT(gain[0], 0);
        EXPECT_GT(gain[gain.size() - 1], 0.1 * C.diagonal().maxCoeff());
    }
}

class QuadraticTetrahedraBy : public testing::TestWithParam<test::ExactMethod> {};

INSTANTIATE_TEST_SUITE_P(by, QuadraticTetrahedraBy, testing::ValuesIn(test::exact_methods()), test::name_of);

TEST_P(QuadraticTetrahedraBy, condense_to_the_compliance_of_dense_solves) {
    const DeformableBody body = prepared_body(two_material_block(ElementOrder::quadratic));
    const Eigen::MatrixXd C = GetParam().compliance(body);
    ASSERT_EQ(C.rows(), static_cast<Eigen::Index>(3 * body.contact_nodes.size()));
    const elasticity::Discretisation d = elasticity::discretise(body);
    for (const std::size_t k :
         {std::size_t{0}, body.contact_nodes.size() / 2, body.contact_nodes.size() - 1}) {
        Eigen::VectorXd force = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(3 * d.node_count));
        force[3 * body.contact_nodes[k] + 1] = 1;
        const Eigen::VectorXd u =
            test::solve_dense(body, d.fixed_nodes, Eigen::VectorXd::Zero(force.size()), force);
        const Eigen::VectorXd column = C.col(static_cast<Eigen::Index>(3 * k + 1));
        for (std::size_t i = 0; i < body.contact_nodes.size(); ++i)
            EXPECT_LT((column.segment<3>(static_cast<Eigen::Index>(3 * i)) -
                       u.segment<3>(3 * body.contact_nodes[i]))
                          .cwiseAbs()
                          .maxCoeff(),
                      space_solve_tolerance * column.cwiseAbs().maxCoeff());
    }
}

TEST(QuadraticTetrahedra, are_certified_by_their_own_stiffness) {
    DeformableBody body = condensed_body(two_material_block(ElementOrder::quadratic), no_progress);
    EXPECT_LT(body.certificate.residual_double, space_solve_tolerance);
    EXPECT_LT(recertify(body, 5, 20, 99).residual, 1e-6);  // float32 as stored
    body.element_order = ElementOrder::linear;
    EXPECT_GT(recertify(body, 5, 20, 99).residual, 1e-2);
}

}  // namespace
}  // namespace palpate
