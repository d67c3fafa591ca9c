// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/boundary_conditions.hpp"

#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "tests/tools/fem/blocks.hpp"

namespace palpate {
namespace {

std::string motion_message(const TetMesh& mesh, const std::vector<std::int32_t>& fixed) {
    try {
        require_no_rigid_motion(mesh, fixed);
        return "";
    } catch (const InvalidInput& error) {
        return error.what();
    }
}

TEST(FixedRules, every_kind_selects_the_surface_nodes_it_describes) {
    const TetMesh mesh = test::block_mesh({4, 4, 4}, {4, 4, 4});
    const BoundarySurface boundary = boundary_surface(mesh);
    const std::vector<FixedRule> floor{parse_fixed_rule("plane:0,0,0.5,0,0,-1")};
    EXPECT_EQ(fixed_nodes_of(mesh, boundary, floor).size(), 25U);
    const std::vector<FixedRule> corner{parse_fixed_rule("sphere:0,0,0,1.2")};
    EXPECT_EQ(fixed_nodes_of(mesh, boundary, corner).size(), 4U);
    // The whole block as a box: interior nodes stay free.
    const std::vector<FixedRule> all{parse_fixed_rule("box:-1,-1,-1,5,5,5")};
    EXPECT_EQ(fixed_nodes_of(mesh, boundary, all).size(), 125U - 27U);
}

TEST(FixedRules, touching_reads_what_lies_outside) {
    TetMesh mesh = test::block_mesh({2, 2, 2}, {2, 2, 2});
    mesh.outside_labels.assign(mesh.rest_positions.size(), 0);
    mesh.outside_labels[5] = mesh.outside_labels[7] = 9;
    mesh.outside_names = {{9, "skull", {1, 1, 1}}};
    const BoundarySurface boundary = boundary_surface(mesh);
    const std::vector<FixedRule> skull{parse_fixed_rule("touching:skull")};
    EXPECT_EQ(fixed_nodes_of(mesh, boundary, skull), (std::vector<std::int32_t>{5, 7}));
    const std::vector<FixedRule> unknown{parse_fixed_rule("touching:skul")};
    EXPECT_THROW(fixed_nodes_of(mesh, boundary, unknown), InvalidInput);
}

TEST(FixedRules, a_rule_that_holds_nothing_is_refused) {
    const TetMesh mesh = test::block_mesh({1, 1, 1}, {1, 1, 1});
    const std::vector<FixedRule> rules{parse_fixed_rule("sphere:50,0,0,1")};
    EXPECT_THROW(fixed_nodes_of(mesh, boundary_surface(mesh), rules), InvalidInput);
}

TEST(FixedRules, malformed_text_is_a_usage_error) {
    for (const char* text :
         {"", "touching:", "ball:1,2,3", "sphere:1,2,3", "box:1,2,3,4,5,x", "plane:0,0,0,1,0,0,0"})
        EXPECT_THROW(parse_fixed_rule(text), UsageError) << text;
}

TEST(RigidMotions, each_way_of_holding_too_little_is_named) {
    const TetMesh mesh = test::block_mesh({2, 2, 2}, {2, 2, 2});
    EXPECT_NE(motion_message(mesh, {}).find("no node is held"), std::string::npos);
    EXPECT_NE(motion_message(mesh, {0}).find("only held point"), std::string::npos);
    EXPECT_NE(motion_message(mesh, {0, 1, 2}).find("line of its held nodes"), std::string::npos);
    EXPECT_EQ(motion_message(mesh, {0, 2, 6}), "");
}

TEST(RigidMotions, a_second_part_must_be_held_too) {
    TetMesh mesh = test::block_mesh({1, 1, 1}, {1, 1, 1});
    const TetMesh other = test::block_mesh({1, 1, 1}, {1, 1, 1});
    for (const auto& p : other.rest_positions)
        mesh.rest_positions.emplace_back(p + Eigen::Vector3d(10, 0, 0));
    for (auto tet : other.tetrahedra) {
        for (auto& node : tet) node += 8;
        mesh.tetrahedra.push_back(tet);
        mesh.regions.push_back(1);
    }
    EXPECT_NE(motion_message(mesh, {0, 1, 2, 3}).find("its part around"), std::string::npos);
    EXPECT_EQ(motion_message(mesh, {0, 1, 2, 8, 9, 10}), "");
}

}  // namespace
}  // namespace palpate
