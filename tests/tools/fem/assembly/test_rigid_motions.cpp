// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <gtest/gtest.h>
#include <map>
#include <numeric>
#include <random>
#include <set>

#include "formats/model/errors.hpp"
#include "tests/tools/fem/blocks.hpp"
#include "tools/fem/assembly/rigid_motions.hpp"

namespace palpate {
namespace {

using Nodes = std::vector<std::int32_t>;

std::string motion_message(const TetMesh& mesh, const Nodes& fixed) {
    try {
        fem::require_no_rigid_motion(mesh, fixed);
        return "";
    } catch (const InvalidInput& error) {
        return error.what();
    }
}

testing::AssertionResult says(const std::string& text, const std::string& phrase) {
    if (text.find(phrase) != std::string::npos) return testing::AssertionSuccess();
    return testing::AssertionFailure() << "'" << phrase << "' is not in: " << text;
}

// Kuhn cubes of 1 mm with their lowest corners at these places; corners at one place are one node.
TetMesh cubes(const std::vector<std::array<int, 3>>& places) {
    TetMesh mesh;
    const TetMesh cube = test::block_mesh({1, 1, 1}, {1, 1, 1});
    std::map<std::array<int, 3>, std::int32_t> node_at;
    for (const auto& place : places)
        for (const Tetrahedron& tet : cube.tetrahedra) {
            Tetrahedron moved{};
            for (std::size_t c = 0; c < 4; ++c) {
                const Eigen::Vector3d p = cube.rest_positions[static_cast<std::size_t>(tet[c])];
                std::array<int, 3> at = place;
                for (std::size_t axis = 0; axis < 3; ++axis)
                    at[axis] += static_cast<int>(p[static_cast<Eigen::Index>(axis)]);
                const auto [found, isnew] = node_at.emplace(at, static_cast<std::int32_t>(node_at.size()));
                if (isnew) mesh.rest_positions.emplace_back(at[0], at[1], at[2]);
                moved[c] = found->second;
            }
            mesh.tetrahedra.push_back(moved);
            mesh.regions.push_back(1);
        }
    mesh.region_names = {{1, "cubes", {1, 0, 0}}};
    return mesh;
}

Nodes nodes_at(const TetMesh& mesh, const std::vector<Eigen::Vector3d>& points) {
    return test::nodes_where(mesh, [&](const Eigen::Vector3d& p) {
        return std::ranges::any_of(points, [&](const Eigen::Vector3d& q) { return (p - q).norm() < 1e-9; });
    });
}

// True if the stiffness without the fixed nodes is regular: the theorem behind the rules.
bool is_regular(const TetMesh& mesh, const Nodes& fixed) {
    DeformableBody body;
    body.mesh = mesh;
    body.materials = {{1, {.youngs_modulus = 1, .poissons_ratio = 0.3}}};
    const Eigen::MatrixXd K = test::full_stiffness(body);
    std::vector<Eigen::Index> free;
    for (Eigen::Index dof = 0; dof < K.rows(); ++dof)
        if (!std::ranges::binary_search(fixed, static_cast<std::int32_t>(dof / 3))) free.push_back(dof);
    const Eigen::MatrixXd K_free = K(free, free);
    const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(K_free).eigenvalues();
    // Round-off leaves 1e-15 of the largest; a handful of cubes has no elastic mode below 1e-6 of it.
    return values[0] > 1e-10 * values[values.size() - 1];
}

TEST(RigidMotions, each_way_of_holding_too_little_is_named) {
    const TetMesh mesh = test::block_mesh({2, 2, 2}, {2, 2, 2});
    EXPECT_TRUE(says(motion_message(mesh, {}), "the body: can translate and rotate freely: no node is held"));
    EXPECT_TRUE(says(motion_message(mesh, {0}), "only held point (0.0, 0.0, 0.0) mm"));
    EXPECT_TRUE(says(motion_message(mesh, {0, 1, 2}),
                     "line of its held nodes, through (0.0, 0.0, 0.0) mm along (1.000, 0.000, 0.000)"));
    EXPECT_EQ(motion_message(mesh, {0, 2, 6}), "");
}

TEST(RigidMotions, a_loose_part_is_named_by_place_and_size) {
    const TetMesh mesh = cubes({{0, 0, 0}, {10, 20, 30}});
    const Nodes first{0, 1, 2, 3, 4, 5, 6, 7};
    EXPECT_TRUE(says(motion_message(mesh, first),
                     "its part of 6 tetrahedra around (11, 21, 31) mm, 1.0 x 1.0 x 1.0 mm: can translate"));
    Nodes both = first;
    for (const std::int32_t node : {8, 9, 10, 11}) both.push_back(node);
    EXPECT_EQ(motion_message(mesh, both), "");
}

TEST(RigidMotions, a_part_that_hangs_by_an_edge_is_named_with_its_axis) {
    const TetMesh mesh = cubes({{0, 0, 0}, {1, 1, 0}});
    const Nodes base = nodes_at(mesh, {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}});
    const std::string text = motion_message(mesh, base);
    EXPECT_TRUE(says(text, "its part of 6 tetrahedra around (2, 2, 1) mm"));
    EXPECT_TRUE(says(text, "through (1.0, 1.0, 0.0) mm along (0.000, 0.000, 1.000)"));
    EXPECT_TRUE(says(text, "hangs by nodes"));
    EXPECT_TRUE(says(text, "without the hinge"));
    // One more node off the axis holds it.
    Nodes held = base;
    held.push_back(nodes_at(mesh, {{2, 2, 0}}).front());
    std::ranges::sort(held);
    EXPECT_EQ(motion_message(mesh, held), "");
}

TEST(RigidMotions, a_part_that_hangs_by_a_node_is_named_with_it) {
    const TetMesh mesh = cubes({{0, 0, 0}, {1, 1, 1}});
    const std::string text = motion_message(mesh, nodes_at(mesh, {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}));
    EXPECT_TRUE(says(text, "hangs by node"));
    EXPECT_TRUE(says(text, "rotate about it, at (1.0, 1.0, 1.0) mm"));
}

TEST(RigidMotions, of_a_chain_the_hinge_nearest_to_what_holds_is_named) {
    const TetMesh mesh = cubes({{2, 2, 0}, {1, 1, 0}, {0, 0, 0}});
    const std::string text = motion_message(mesh, nodes_at(mesh, {{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}));
    EXPECT_TRUE(says(text, "around (2, 2, 1) mm"));
    EXPECT_TRUE(says(text, "through (1.0, 1.0, 0.0) mm"));
}

TEST(RigidMotions, parts_that_share_three_nodes_off_a_line_move_as_one) {
    // Two tetrahedra of different diagonals on one square share three of its corners, but no face.
    TetMesh mesh = cubes({{0, 0, 0}});
    const Nodes square = nodes_at(mesh, {{0, 0, 1}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}});
    ASSERT_EQ(square.size(), 4U);
    const auto at = [&](double x, double y) { return nodes_at(mesh, {{x, y, 1}}).front(); };
    const std::set<std::int32_t> diagonal{at(0, 0), at(1, 1)};
    const bool kuhn = std::ranges::any_of(mesh.tetrahedra, [&](const Tetrahedron& tet) {
        return std::ranges::all_of(diagonal,
                                   [&](auto node) { return std::ranges::find(tet, node) != tet.end(); });
    });
    ASSERT_TRUE(kuhn) << "the cube's top is cut from (0, 0) to (1, 1)";
    const auto apex = static_cast<std::int32_t>(mesh.rest_positions.size());
    mesh.rest_positions.emplace_back(0.5, 0.5, 2);
    mesh.tetrahedra.push_back({at(0, 0), at(1, 0), at(0, 1), apex});
    mesh.regions.push_back(1);
    ASSERT_GT(six_volume(mesh, 6), 0);
    const Nodes floor = nodes_at(mesh, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    EXPECT_EQ(motion_message(mesh, floor), "");
    EXPECT_TRUE(is_regular(mesh, floor));
}

// Two cubes meet at (1, 1, 1), each held on an edge: about these edges, (1, 1, 1) can move in one direction
// each.
TEST(RigidMotions, parts_that_lock_each_other_are_accepted) {
    const TetMesh mesh = cubes({{0, 0, 0}, {1, 1, 1}});
    const Nodes locked = nodes_at(mesh, {{0, 0, 0}, {1, 0, 0}, {2, 2, 2}, {2, 1, 2}});
    EXPECT_EQ(motion_message(mesh, locked), "");
    EXPECT_TRUE(is_regular(mesh, locked));
    const Nodes parallel = nodes_at(mesh, {{0, 0, 0}, {1, 0, 0}, {1, 2, 2}, {2, 2, 2}});
    EXPECT_TRUE(says(motion_message(mesh, parallel), "along (1.000, 0.000, 0.000)"));
    EXPECT_FALSE(is_regular(mesh, parallel));
}

// Four cubes in a ring, edge to edge, are a four-bar linkage; a fifth on top locks it; a sixth hangs by a
// node.
TEST(RigidMotions, are_found_where_and_only_where_the_stiffness_is_singular) {
    std::vector<std::array<int, 3>> places{{0, 0, 0}, {1, 1, 0}, {2, 0, 0}, {1, -1, 0}};
    int regular = 0, singular = 0;
    for (const std::array<int, 3>& more : {std::array{1, 0, 1}, std::array{2, 1, 2}, std::array{9, 9, 9}}) {
        const TetMesh mesh = cubes(places);
        for (unsigned seed = 0; seed < 30; ++seed) {
            std::mt19937 random(seed);
            std::vector<std::int32_t> nodes(mesh.rest_positions.size());
            std::iota(nodes.begin(), nodes.end(), 0);
            std::ranges::shuffle(nodes, random);
            Nodes fixed(nodes.begin(), nodes.begin() + 2 + seed % 6);
            std::ranges::sort(fixed);
            const bool expected = is_regular(mesh, fixed);
            (expected ? regular : singular)++;
            EXPECT_EQ(motion_message(mesh, fixed).empty(), expected)
                << places.size() << " cubes, seed " << seed << ": " << motion_message(mesh, fixed);
        }
        places.push_back(more);
    }
    EXPECT_GT(regular, 10);
    EXPECT_GT(singular, 10);
}

TEST(RigidMotions, a_node_of_no_tetrahedron_is_named) {
    TetMesh mesh = cubes({{0, 0, 0}});
    mesh.rest_positions.emplace_back(5, 5, 5);
    EXPECT_TRUE(says(motion_message(mesh, {0, 1, 2, 3}), "node 8: belongs to no tetrahedron"));
    EXPECT_EQ(motion_message(mesh, {0, 1, 2, 3, 8}), "");
}

}  // namespace
}  // namespace palpate
