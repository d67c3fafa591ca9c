// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/condense.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cstring>
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "tests/tools/fem/blocks.hpp"
#include "tools/fem/certificate.hpp"

namespace palpate {
namespace {

const Material soft{.youngs_modulus = 6e-3, .poissons_ratio = 0.45};
// The condensed compliance passes through two factorisations of matrices with condition 1e4 or so.
constexpr double solve_tolerance = 1e-11;

void no_progress(std::string_view, double) {}

DeformableBody small_body() {
    auto body = test::held_block({4, 3, 3}, {8, 6, 7}, soft);
    test::jitter_interior(body.mesh, 0.4, 3);
    body.mesh.regions[20] = body.mesh.regions[21] = 2;
    body.mesh.region_names.push_back({2, "lump", {0, 1, 0}});
    body.materials.push_back({2, {.youngs_modulus = 30e-3, .poissons_ratio = 0.4}});
    return condensed_body(body, no_progress);
}

std::vector<Eigen::Index> dofs_of(const std::vector<std::int32_t>& nodes) {
    std::vector<Eigen::Index> dofs;
    for (const std::int32_t node : nodes)
        for (Eigen::Index c = 0; c < 3; ++c) dofs.push_back(3 * Eigen::Index{node} + c);
    return dofs;
}

Eigen::MatrixXd symmetric(const Eigen::MatrixXd& lower) {
    return Eigen::MatrixXd(lower.selfadjointView<Eigen::Lower>());
}

TEST(Condensation, equals_direct_solves_of_the_full_system) {
    const DeformableBody body = small_body();
    const Eigen::MatrixXd C = symmetric(condense(body, no_progress).lower);
    const auto surface = dofs_of(body.contact_nodes);
    for (const std::size_t column : {std::size_t{0}, surface.size() / 2, surface.size() - 1}) {
        Eigen::VectorXd force =
            Eigen::VectorXd::Zero(static_cast<Eigen::Index>(3 * body.mesh.rest_positions.size()));
        force[surface[column]] = 1;
        const Eigen::VectorXd u =
            test::solve_dense(body, body.fixed_nodes, Eigen::VectorXd::Zero(force.size()), force);
        const Eigen::VectorXd expected = u(surface);
        EXPECT_LT((C.col(static_cast<Eigen::Index>(column)) - expected).cwiseAbs().maxCoeff(),
                  solve_tolerance * expected.cwiseAbs().maxCoeff());
    }
}

// Bro-Nielsen 1998: K* = K_ss - K_si K_ii^-1 K_is, and C = (K*)^-1.
TEST(Condensation, inverts_bro_nielsens_condensed_stiffness) {
    const DeformableBody body = small_body();
    const Eigen::MatrixXd K = test::full_stiffness(body);
    std::vector<std::int32_t> interior;
    for (std::int32_t node = 0; node < static_cast<std::int32_t>(body.mesh.rest_positions.size()); ++node)
        if (!std::ranges::binary_search(body.fixed_nodes, node) &&
            !std::ranges::binary_search(body.contact_nodes, node))
            interior.push_back(node);
    const auto s = dofs_of(body.contact_nodes), i = dofs_of(interior);
    const Eigen::MatrixXd Kii = K(i, i), Kis = K(i, s), Kss = K(s, s);
    const Eigen::MatrixXd condensed = Kss - Kis.transpose() * Kii.llt().solve(Kis);
    const Eigen::MatrixXd C = symmetric(condense(body, no_progress).lower);
    const Eigen::MatrixXd identity = C * condensed;
    EXPECT_LT((identity - Eigen::MatrixXd::Identity(C.rows(), C.cols())).cwiseAbs().maxCoeff(), 1e-10);
}

// Hirota & Kaneko 2001: displacements imposed on touched nodes give C_cc f = u_c; the rest follows as C_:c f.
TEST(Condensation, imposed_displacements_equal_the_full_solve) {
    const DeformableBody body = small_body();
    const Eigen::MatrixXd C = symmetric(condense(body, no_progress).lower);
    const std::vector<Eigen::Index> touched{30, 31, 32, 33, 34, 35};  // two contact nodes
    Eigen::VectorXd imposed(6);
    imposed << 0.1, -0.2, -1.0, 0.0, 0.1, -0.8;
    const Eigen::VectorXd force = Eigen::MatrixXd(C(touched, touched)).llt().solve(imposed);
    const Eigen::VectorXd condensed = C(Eigen::all, touched) * force;

    std::vector<std::int32_t> held = body.fixed_nodes;
    held.push_back(body.contact_nodes[10]);
    held.push_back(body.contact_nodes[11]);
    std::ranges::sort(held);
    Eigen::VectorXd prescribed =
        Eigen::VectorXd::Zero(static_cast<Eigen::Index>(3 * body.mesh.rest_positions.size()));
    prescribed.segment<3>(3 * body.contact_nodes[10]) = imposed.head<3>();
    prescribed.segment<3>(3 * body.contact_nodes[11]) = imposed.tail<3>();
    const Eigen::VectorXd full =
        test::solve_dense(body, held, prescribed, Eigen::VectorXd::Zero(prescribed.size()));
    const Eigen::VectorXd expected = full(dofs_of(body.contact_nodes));
    EXPECT_LT((condensed - expected).cwiseAbs().maxCoeff(), solve_tolerance);
}

TEST(Condensation, is_positive_definite_and_its_eigenvalue_estimates_hold) {
    const DeformableBody body = small_body();
    const ExactCompliance exact = condense(body, no_progress);
    const Eigen::VectorXd values =
        Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(symmetric(exact.lower)).eigenvalues();
    EXPECT_GT(values[0], 0);
    EXPECT_NEAR(exact.largest_eigenvalue, values[values.size() - 1], 0.02 * values[values.size() - 1]);
    // Power iteration approaches 1/smallest from below, so the estimate is never below the true smallest.
    EXPECT_GE(exact.smallest_eigenvalue, values[0] * (1 - 1e-9));
    EXPECT_LT(exact.smallest_eigenvalue, 1.2 * values[0]);
}

TEST(Condensation, contact_nodes_are_the_boundary_without_the_held) {
    const DeformableBody body = small_body();
    EXPECT_EQ(body.contact_nodes.size() + body.fixed_nodes.size(), body.boundary.nodes.size());
    EXPECT_EQ(body.compliance.node_count, static_cast<std::int32_t>(body.contact_nodes.size()));
}

TEST(Condensation, same_input_gives_the_same_bytes) {
    const DeformableBody a = small_body(), b = small_body();
    const std::size_t bytes = a.compliance.dof_count() * a.compliance.dof_count() * sizeof(float);
    EXPECT_EQ(std::memcmp(a.compliance.entries.get(), b.compliance.entries.get(), bytes), 0);
}

TEST(Condensation, refuses_a_body_that_nothing_holds_before_factorising) {
    auto body = test::held_block({2, 2, 2}, {1, 1, 1}, soft);
    body.fixed_nodes.clear();
    EXPECT_THROW(condensed_body(body, no_progress), InvalidInput);
}

TEST(Condensation, refuses_a_body_that_is_held_everywhere) {
    auto body = test::held_block({2, 2, 2}, {1, 1, 1}, soft);
    body.fixed_nodes = boundary_surface(body.mesh).nodes;
    EXPECT_THROW(condensed_body(body, no_progress), InvalidInput);
}

TEST(Certificate, of_a_sound_body_is_clean) {
    const DeformableBody body = small_body();
    const Certificate& c = body.certificate;
    EXPECT_LT(c.residual_double, 1e-10);
    EXPECT_LT(c.residual, 1e-6);
    EXPECT_EQ(c.asymmetry, 0);
    EXPECT_LT(c.reciprocity, 1e-12);
    EXPECT_EQ(c.sampled_columns, certificate_columns);
    const Certificate again = recertify(body, 5, 99);
    EXPECT_LT(again.residual, 1e-6);
    EXPECT_NEAR(again.smallest_eigenvalue, c.smallest_eigenvalue, 1e-3 * c.smallest_eigenvalue);
}

TEST(Certificate, catches_a_compliance_of_another_material) {
    DeformableBody body = small_body();
    body.materials[0].material.youngs_modulus *= 1.01;
    EXPECT_GT(recertify(body, 5, 99).residual, 1e-3);
}

TEST(Certificate, catches_asymmetry_and_indefiniteness) {
    DeformableBody body = small_body();
    const std::size_t n = body.compliance.dof_count();
    std::shared_ptr<float[]> entries(new float[n * n]);
    std::memcpy(entries.get(), body.compliance.entries.get(), n * n * sizeof(float));
    entries[5 * n + 3] *= 1.5F;
    entries[7 * n + 7] *= -1;
    body.compliance.entries = std::shared_ptr<const float>(entries, entries.get());
    const Certificate certificate = recertify(body, 5, 99);
    EXPECT_GT(certificate.asymmetry, 0);
    EXPECT_EQ(certificate.smallest_eigenvalue, 0);
}

}  // namespace
}  // namespace palpate
