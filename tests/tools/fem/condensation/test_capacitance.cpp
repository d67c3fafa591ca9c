// SPDX-License-Identifier: GPL-3.0-or-later
// James & Pai, "ArtDefo", SIGGRAPH 1999: holding contact nodes of a condensed body takes the inverse of their
// compliance, the capacitance matrix, instead of a new factorisation.
#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <gtest/gtest.h>

#include "tests/tools/fem/blocks.hpp"
#include "tests/tools/fem/compliances.hpp"

namespace palpate {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using test::dofs_of;

// Two factorisations, and the inverse of a small matrix of condition 1e3.
constexpr double capacitance_tolerance = 1e-10;

// Displacements of the contact nodes by a new dense factorisation of the stiffness: `held` contact nodes at
// imposed places, forces on the others.
VectorXd refactorised(const DeformableBody& body, const std::vector<std::int32_t>& held,
                      const VectorXd& imposed, const VectorXd& forces) {
    std::vector<std::int32_t> all_held = body.fixed_nodes;
    const auto n = static_cast<Index>(3 * body.mesh.rest_positions.size());
    VectorXd prescribed = VectorXd::Zero(n), nodal = VectorXd::Zero(n);
    nodal(dofs_of(body.contact_nodes)) = forces;
    for (std::size_t k = 0; k < held.size(); ++k) {
        const std::int32_t node = body.contact_nodes[static_cast<std::size_t>(held[k])];
        all_held.push_back(node);
        prescribed.segment<3>(3 * node) = imposed.segment<3>(3 * static_cast<Index>(k));
    }
    std::ranges::sort(all_held);
    return test::solve_dense(body, all_held, prescribed, nodal)(dofs_of(body.contact_nodes));
}

// The same by the capacitance: what u = C f misses at the held nodes is made up by forces on them.
VectorXd updated(const MatrixXd& C, const MatrixXd& capacitance, const std::vector<std::int32_t>& held,
                 const VectorXd& imposed, const VectorXd& forces) {
    const VectorXd free = C * forces;
    const auto c = dofs_of(held);
    return free + C(Eigen::all, c) * (capacitance * (imposed - free(c)));
}

MatrixXd capacitance_of(const MatrixXd& C, const std::vector<std::int32_t>& held) {
    const auto c = dofs_of(held);
    return MatrixXd(C(c, c)).llt().solve(
        MatrixXd::Identity(static_cast<Index>(c.size()), static_cast<Index>(c.size())));
}

// (C_SS)^-1 of S and one more node, by the Schur complement of the new block.
MatrixXd with_node_added(const MatrixXd& C, const MatrixXd& capacitance,
                         const std::vector<std::int32_t>& held, std::int32_t added) {
    const auto s = dofs_of(held), a = dofs_of({added});
    const MatrixXd carried = capacitance * C(s, a), coupling = C(a, s);
    const MatrixXd own = (MatrixXd(C(a, a)) - coupling * carried).inverse();
    const Index size = capacitance.rows();
    MatrixXd result(size + 3, size + 3);
    result << capacitance + carried * own * carried.transpose(), -carried * own, -own * carried.transpose(),
        own;
    return result;
}

// (C_SS)^-1 without the node at place k of S: the Schur complement in the inverse.
MatrixXd with_node_removed(const MatrixXd& capacitance, std::int32_t k) {
    std::vector<std::int32_t> others;
    for (std::int32_t i = 0; i < capacitance.rows() / 3; ++i)
        if (i != k) others.push_back(i);
    const auto o = dofs_of(others), r = dofs_of({k});
    return capacitance(o, o) - capacitance(o, r) * MatrixXd(capacitance(r, r)).inverse() * capacitance(r, o);
}

struct Setting {
    DeformableBody body = test::lumpy_block();
    VectorXd forces, imposed;  // on all contact nodes; of four held ones

    Setting() {
        std::srand(5);  // Eigen's Random
        forces = 1e-3 * VectorXd::Random(static_cast<Index>(3 * body.contact_nodes.size()));
        imposed = 0.5 * VectorXd::Random(12);
    }
};

const std::vector<std::int32_t> held{3, 17, 18, 40};  // two neighbours among them

class CapacitanceUpdateBy : public testing::TestWithParam<test::ExactMethod> {};

INSTANTIATE_TEST_SUITE_P(by, CapacitanceUpdateBy, testing::ValuesIn(test::exact_methods()), test::name_of);

TEST_P(CapacitanceUpdateBy, equals_refactorising_with_the_nodes_held) {
    const Setting s;
    const MatrixXd C = GetParam().compliance(s.body);
    const VectorXd expected = refactorised(s.body, held, s.imposed, s.forces);
    const VectorXd found = updated(C, capacitance_of(C, held), held, s.imposed, s.forces);
    EXPECT_LT((found - expected).cwiseAbs().maxCoeff(),
              capacitance_tolerance * expected.cwiseAbs().maxCoeff());
}

// C' = C - C_:c C_cc^-1 C_c: is the compliance of the body whose fixed nodes include c.
TEST_P(CapacitanceUpdateBy, gives_the_compliance_of_the_body_held_at_more_nodes) {
    const Setting s;
    const MatrixXd C = GetParam().compliance(s.body);
    const auto c = dofs_of(held);
    const MatrixXd lessened = C - C(Eigen::all, c) * capacitance_of(C, held) * C(c, Eigen::all);

    DeformableBody more = s.body;
    std::vector<std::int32_t> remaining;
    for (std::int32_t k = 0; k < static_cast<std::int32_t>(s.body.contact_nodes.size()); ++k) {
        const std::int32_t node = s.body.contact_nodes[static_cast<std::size_t>(k)];
        if (std::ranges::binary_search(held, k))
            more.fixed_nodes.push_back(node);
        else
            remaining.push_back(k);
    }
    std::ranges::sort(more.fixed_nodes);
    std::erase_if(more.contact_nodes,
                  [&](std::int32_t node) { return std::ranges::binary_search(more.fixed_nodes, node); });
    const MatrixXd expected = GetParam().compliance(more);
    const auto r = dofs_of(remaining);
    EXPECT_LT((MatrixXd(lessened(r, r)) - expected).cwiseAbs().maxCoeff(),
              capacitance_tolerance * expected.cwiseAbs().maxCoeff());
}

TEST(CapacitanceUpdate, follows_a_node_that_is_held_and_let_go_again) {
    const Setting s;
    const MatrixXd C = test::exact_methods()[0].compliance(s.body);
    const std::vector<std::int32_t> before{3, 17, 18}, after{3, 18, 40};
    const MatrixXd grown = with_node_added(C, capacitance_of(C, before), before, 40);
    const VectorXd all = refactorised(s.body, held, s.imposed, s.forces);
    EXPECT_LT((updated(C, grown, held, s.imposed, s.forces) - all).cwiseAbs().maxCoeff(),
              capacitance_tolerance * all.cwiseAbs().maxCoeff());

    const MatrixXd shrunk = with_node_removed(grown, 1);  // contact node 17
    const VectorXd imposed = s.imposed(dofs_of({0, 2, 3}));
    const VectorXd expected = refactorised(s.body, after, imposed, s.forces);
    EXPECT_LT((updated(C, shrunk, after, imposed, s.forces) - expected).cwiseAbs().maxCoeff(),
              capacitance_tolerance * expected.cwiseAbs().maxCoeff());
}

}  // namespace
}  // namespace palpate
