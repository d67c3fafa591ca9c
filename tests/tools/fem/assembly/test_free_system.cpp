// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>
#include <string>

#include "formats/model/errors.hpp"
#include "tests/tools/fem/compliances.hpp"
#include "tools/fem/solvers/free_system.hpp"

namespace palpate {
namespace {

using namespace fem;

// The message of factorising the body's stiffness after the node's own stiffness along y was made negative.
std::string refusal(const DeformableBody& body, std::size_t node, NodeOrder order, Elimination elimination) {
    FreeSystem system = assemble_free_system(body, order);
    const std::int64_t row = 3 * std::int64_t{system.position_of_node[node]} + 1;
    system.stiffness.coeffRef(row, row) = -1;
    try {
        factorise(body, system, elimination);
    } catch (const InvalidInput& error) {
        return error.what();
    }
    return "";
}

TEST(Factorisation, names_the_node_where_the_stiffness_is_not_positive_definite) {
    const DeformableBody body = test::lumpy_block();
    const std::size_t node = 42;
    for (const NodeOrder order :
         {NodeOrder::as_numbered, NodeOrder::nested_dissection, NodeOrder::surface_last})
        for (const Elimination elimination : {Elimination::as_given, Elimination::fill_reducing}) {
            const std::string message = refusal(body, node, order, elimination);
            EXPECT_NE(message.find("not positive definite at node 42 at ("), std::string::npos) << message;
        }
}

TEST(Factorisation, names_the_edge_where_the_stiffness_is_not_positive_definite) {
    DeformableBody body = test::lumpy_block();
    body.element_order = ElementOrder::quadratic;
    const std::size_t corners = body.mesh.rest_positions.size();
    const FreeSystem system = assemble_free_system(body, NodeOrder::as_numbered);
    std::size_t edge = elasticity::discretise(body).edges.size() - 1;
    while (system.position_of_node[corners + edge] < 0) --edge;
    const auto [a, b] = elasticity::discretise(body).edges[edge];
    const std::string message =
        refusal(body, corners + edge, NodeOrder::nested_dissection, Elimination::as_given);
    EXPECT_NE(message.find("not positive definite at the middle of nodes " + std::to_string(a) + " and " +
                           std::to_string(b)),
              std::string::npos)
        << message;
}

TEST(FreeSystem, is_the_same_matrix_in_every_order) {
    const DeformableBody body = test::lumpy_block();
    const auto by_node = [&](NodeOrder order) {
        const FreeSystem system = assemble_free_system(body, order);
        const Eigen::MatrixXd K(Eigen::MatrixXd(system.stiffness).selfadjointView<Eigen::Lower>());
        std::vector<std::int32_t> positions;
        for (const std::int32_t position : system.position_of_node)
            if (position >= 0) positions.push_back(position);
        const auto rows = test::dofs_of(positions);
        return Eigen::MatrixXd(K(rows, rows));
    };
    const Eigen::MatrixXd K = by_node(NodeOrder::as_numbered);
    // Elements are added in another order.
    const double round_off = 1e-14 * K.cwiseAbs().maxCoeff();
    EXPECT_LT((by_node(NodeOrder::nested_dissection) - K).cwiseAbs().maxCoeff(), round_off);
    EXPECT_LT((by_node(NodeOrder::surface_last) - K).cwiseAbs().maxCoeff(), round_off);
}

}  // namespace
}  // namespace palpate
