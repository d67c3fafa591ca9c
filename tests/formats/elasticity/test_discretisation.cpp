// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <gtest/gtest.h>
#include <numeric>
#include <set>

#include "formats/elasticity/discretisation.hpp"
#include "tests/tools/fem/blocks.hpp"

namespace palpate {
namespace {

using namespace elasticity;

const Material liver_like{.youngs_modulus = 6e-3, .poissons_ratio = 0.45};

DeformableBody quadratic_block(std::array<int, 3> cells) {
    auto body = test::held_block(cells, {4, 5, 6}, liver_like);
    body.element_order = ElementOrder::quadratic;
    return body;
}

TEST(Discretisation, of_linear_elements_is_the_mesh) {
    const auto body = test::held_block({2, 3, 2}, {4, 5, 6}, liver_like);
    const Discretisation d = discretise(body);
    EXPECT_EQ(d.nodes_per_element, 4);
    EXPECT_EQ(d.node_count, body.mesh.rest_positions.size());
    EXPECT_EQ(d.fixed_nodes, body.fixed_nodes);
    EXPECT_TRUE(d.edges.empty());
    for (std::size_t t = 0; t < body.mesh.tetrahedra.size(); ++t)
        EXPECT_TRUE(std::ranges::equal(nodes_of_element(d, t), body.mesh.tetrahedra[t]));
}

TEST(Discretisation, every_edge_has_one_middle_that_its_elements_share) {
    const auto body = quadratic_block({2, 3, 2});
    const Discretisation d = discretise(body);
    const auto mesh_nodes = static_cast<std::int32_t>(body.mesh.rest_positions.size());
    EXPECT_EQ(d.nodes_per_element, 10);
    EXPECT_EQ(d.elements.size(), 10 * body.mesh.tetrahedra.size());
    EXPECT_EQ(d.node_count, body.mesh.rest_positions.size() + d.edges.size());
    std::set<std::array<std::int32_t, 2>> expected;
    for (std::size_t t = 0; t < body.mesh.tetrahedra.size(); ++t) {
        const auto nodes = nodes_of_element(d, t);
        EXPECT_TRUE(std::ranges::equal(nodes.first(4), body.mesh.tetrahedra[t]));
        // As the interface has it: (0,1) (1,2) (0,2) (0,3) (1,3) (2,3).
        constexpr std::array<std::array<std::size_t, 2>, 6> ends{
            {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}}};
        for (std::size_t e = 0; e < 6; ++e) {
            const std::array<std::int32_t, 2> edge{std::min(nodes[ends[e][0]], nodes[ends[e][1]]),
                                                   std::max(nodes[ends[e][0]], nodes[ends[e][1]])};
            expected.insert(edge);
            EXPECT_EQ(d.edges.at(static_cast<std::size_t>(nodes[4 + e] - mesh_nodes)), edge);
        }
    }
    EXPECT_TRUE(std::ranges::equal(d.edges, expected));
}

// Euler's relation of a ball cut into tetrahedra: nodes - edges + faces - tetrahedra = 1.
TEST(Discretisation, edges_of_a_block_satisfy_eulers_relation) {
    const auto body = quadratic_block({3, 2, 4});
    const std::size_t tetrahedra = body.mesh.tetrahedra.size(),
                      faces = (4 * tetrahedra + boundary_surface(body.mesh).surface.triangles.size()) / 2;
    EXPECT_EQ(body.mesh.rest_positions.size() + faces, 1 + tetrahedra + discretise(body).edges.size());
}

TEST(Discretisation, holds_middles_of_held_boundary_edges_only) {
    auto body = quadratic_block({2, 2, 2});
    const auto mesh_nodes = static_cast<std::int32_t>(body.mesh.rest_positions.size());
    const auto held_middles = [&] {
        const Discretisation d = discretise(body);
        EXPECT_TRUE(std::ranges::is_sorted(d.fixed_nodes));
        EXPECT_TRUE(
            std::ranges::equal(body.fixed_nodes, std::span(d.fixed_nodes).first(body.fixed_nodes.size())));
        std::vector<std::array<std::int32_t, 2>> edges;
        for (const std::int32_t node : std::span(d.fixed_nodes).subspan(body.fixed_nodes.size()))
            edges.push_back(d.edges.at(static_cast<std::size_t>(node - mesh_nodes)));
        return edges;
    };
    // The floor of 2 x 2 squares, each cut by a diagonal: 12 sides and 4 diagonals.
    EXPECT_EQ(held_middles().size(), 16U);
    // Both ends of every edge are held here, yet those that run through the inside stay free.
    body.fixed_nodes.resize(body.mesh.rest_positions.size());
    std::iota(body.fixed_nodes.begin(), body.fixed_nodes.end(), 0);
    EXPECT_EQ(held_middles(), boundary_edges(body.mesh));
    EXPECT_EQ(boundary_edges(body.mesh).size(), 3U * 48U / 2U);
    EXPECT_GT(discretise(body).edges.size(), boundary_edges(body.mesh).size());
    // An edge across the floor's corner, with one end held, stays free.
    body.fixed_nodes = {0};
    EXPECT_TRUE(held_middles().empty());
}

TEST(NodeGraph, joins_nodes_that_share_an_element_and_leaves_others_out) {
    const auto body = quadratic_block({2, 1, 1});
    const Discretisation d = discretise(body);
    std::vector<std::int32_t> position(d.node_count);
    // Reversed, and without the first node.
    for (std::size_t node = 0; node < d.node_count; ++node)
        position[node] = node == 0 ? -1 : static_cast<std::int32_t>(d.node_count - 1 - node);
    std::vector<std::set<std::int32_t>> expected(d.node_count - 1);
    for (std::size_t t = 0; t < body.mesh.tetrahedra.size(); ++t)
        for (const std::int32_t a : nodes_of_element(d, t))
            for (const std::int32_t b : nodes_of_element(d, t))
                if (a != 0 && b != 0)
                    expected[static_cast<std::size_t>(position[static_cast<std::size_t>(a)])].insert(
                        position[static_cast<std::size_t>(b)]);
    const NodeGraph graph = node_graph(d, position);
    ASSERT_EQ(graph.offsets.size(), expected.size() + 1);
    for (std::size_t p = 0; p < expected.size(); ++p)
        EXPECT_TRUE(std::ranges::equal(
            std::span(graph.neighbours)
                .subspan(static_cast<std::size_t>(graph.offsets[p]),
                         static_cast<std::size_t>(graph.offsets[p + 1] - graph.offsets[p])),
            expected[p]));
}

}  // namespace
}  // namespace palpate
