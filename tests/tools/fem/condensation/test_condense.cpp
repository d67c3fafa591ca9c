// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Cholesky>
#include <algorithm>
#include <cstring>
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "tests/tools/fem/blocks.hpp"
#include "tests/tools/fem/compliances.hpp"
#include "tools/fem/condensation/condense.hpp"
#include "tools/fem/solvers/dense_kernels.hpp"

namespace palpate {
namespace {

using namespace fem;
using test::dofs_of;
using test::no_progress;

// The condensed compliance passes through two factorisations of matrices with condition 1e4 or so.
constexpr double solve_tolerance = 1e-11;

class CondensationBy : public testing::TestWithParam<test::ExactMethod> {};

INSTANTIATE_TEST_SUITE_P(by, CondensationBy, testing::ValuesIn(test::exact_methods()), test::name_of);

TEST_P(CondensationBy, equals_direct_solves_of_the_full_system) {
    const DeformableBody body = test::lumpy_block();
    const Eigen::MatrixXd C = GetParam().compliance(body);
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
TEST_P(CondensationBy, inverts_bro_nielsens_condensed_stiffness) {
    const DeformableBody body = test::lumpy_block();
    const Eigen::MatrixXd K = test::full_stiffness(body);
    std::vector<std::int32_t> interior;
    for (std::int32_t node = 0; node < static_cast<std::int32_t>(body.mesh.rest_positions.size()); ++node)
        if (!std::ranges::binary_search(body.fixed_nodes, node) &&
            !std::ranges::binary_search(body.contact_nodes, node))
            interior.push_back(node);
    const auto s = dofs_of(body.contact_nodes), i = dofs_of(interior);
    const Eigen::MatrixXd Kii = K(i, i), Kis = K(i, s), Kss = K(s, s);
    const Eigen::MatrixXd condensed = Kss - Kis.transpose() * Kii.llt().solve(Kis);
    const Eigen::MatrixXd C = GetParam().compliance(body);
    const Eigen::MatrixXd identity = C * condensed;
    EXPECT_LT((identity - Eigen::MatrixXd::Identity(C.rows(), C.cols())).cwiseAbs().maxCoeff(), 1e-10);
}

// Hirota & Kaneko 2001: displacements imposed on touched nodes give C_cc f = u_c; the rest follows as C_:c f.
TEST_P(CondensationBy, imposed_displacements_equal_the_full_solve) {
    const DeformableBody body = test::lumpy_block();
    const Eigen::MatrixXd C = GetParam().compliance(body);
    const auto touched = dofs_of({10, 11});  // contact nodes
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

TEST_P(CondensationBy, gives_the_same_bytes_on_every_run) {
    const DeformableBody body = test::large_block();
    const Eigen::MatrixXd once = GetParam().compliance(body), again = GetParam().compliance(body);
    EXPECT_EQ(std::memcmp(once.data(), again.data(), sizeof(double) * static_cast<std::size_t>(once.size())),
              0);
}

// Largest difference relative to the largest entry.
double difference(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
    return (a - b).cwiseAbs().maxCoeff() / b.cwiseAbs().maxCoeff();
}

constexpr double agreement = 1e-12;  // that two exact ways, or numbers of threads, may be apart

TEST(Condensation, both_ways_agree_to_round_off) {
    for (const DeformableBody& body : {test::lumpy_block(), test::large_block()})
        EXPECT_LT(difference(test::full(condense_by_trailing_block(body, no_progress)),
                             test::full(condense_by_solves(body, 2, no_progress))),
                  agreement);
}

TEST_P(CondensationBy, agrees_at_any_number_of_dense_kernels_threads_to_round_off) {
    const DeformableBody body = test::large_block();
    set_linear_algebra_threads(1);
    const Eigen::MatrixXd one = GetParam().compliance(body);
    set_linear_algebra_threads(2);
    EXPECT_LT(difference(GetParam().compliance(body), one), agreement);
}

TEST(Condensation, by_solves_gives_the_same_bytes_at_any_number_of_threads_that_solve) {
    const DeformableBody body = test::large_block();
    const Eigen::MatrixXd one = test::full(condense_by_solves(body, 1, no_progress));
    for (const int threads : {2, 3}) {
        const Eigen::MatrixXd more = test::full(condense_by_solves(body, threads, no_progress));
        EXPECT_EQ(std::memcmp(one.data(), more.data(), sizeof(double) * static_cast<std::size_t>(one.size())),
                  0)
            << threads << " threads";
    }
}

TEST(Condensation, stores_the_nearest_floats_of_both_triangles) {
    const ExactCompliance exact = condense_by_trailing_block(test::lumpy_block(), no_progress);
    const Eigen::MatrixXd expected = test::full(exact).cast<float>().cast<double>();
    EXPECT_EQ(test::entries_of(to_stored(exact)), expected);
}

TEST(Condensation, contact_nodes_are_the_boundary_without_the_held) {
    const DeformableBody body = condensed_body(test::lumpy_block(), no_progress);
    EXPECT_EQ(body.contact_nodes.size() + body.fixed_nodes.size(), body.boundary.nodes.size());
    EXPECT_EQ(node_count(body.compliance), static_cast<std::int32_t>(body.contact_nodes.size()));
}

DeformableBody cube() {
    return test::held_block({2, 2, 2}, {1, 1, 1}, {.youngs_modulus = 6e-3, .poissons_ratio = 0.45});
}

TEST(Condensation, refuses_a_body_that_nothing_holds_before_factorising) {
    DeformableBody body = cube();
    body.fixed_nodes.clear();
    EXPECT_THROW(condensed_body(body, no_progress), InvalidInput);
}

TEST(Condensation, refuses_a_body_that_is_held_everywhere) {
    DeformableBody body = cube();
    body.fixed_nodes = boundary_surface(body.mesh).nodes;
    EXPECT_THROW(condensed_body(body, no_progress), InvalidInput);
}

}  // namespace
}  // namespace palpate
