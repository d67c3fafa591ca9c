// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <numbers>
#include <unistd.h>

#include "formats/model/errors.hpp"
#include "tests/tools/fem/blocks.hpp"
#include "tools/fem/assembly/node_rules.hpp"

namespace palpate {
namespace {

using namespace fem;

using Nodes = std::vector<std::int32_t>;

// A block of 2 mm and 8 cells: node 13 is the only interior one. Region 2 is the cell at (1, 1, 1).
TetMesh small_block() {
    TetMesh mesh = test::block_mesh({2, 2, 2}, {2, 2, 2});
    for (std::size_t t = 42; t < 48; ++t) mesh.regions[t] = 2;
    mesh.region_names.push_back({2, "tumour", {0, 1, 0}});
    mesh.outside_labels.assign(mesh.rest_positions.size(), 0);
    mesh.outside_labels[5] = mesh.outside_labels[7] = 9;
    mesh.outside_names = {{9, "skull", {1, 1, 1}}};
    return mesh;
}

std::vector<NodeRule> rules(const std::string& option, const std::vector<std::string>& texts) {
    std::vector<NodeRule> result;
    for (const std::string& text : texts) result.push_back(parse_node_rule(option, text));
    return result;
}

Nodes fixed(const TetMesh& mesh, const std::vector<std::string>& texts) {
    return fixed_nodes_of(mesh, boundary_surface(mesh), rules("--fixed", texts));
}

Nodes touchable(const TetMesh& mesh, const std::vector<std::string>& texts, const Nodes& fixed_nodes) {
    return contact_nodes_of(mesh, boundary_surface(mesh), rules("--contact", texts), fixed_nodes);
}

template <typename Function>
std::string message(const Function& function) {
    try {
        function();
        return "";
    } catch (const Error& error) {
        return error.what();
    }
}

class NodeLists : public testing::Test {
  protected:
    NodeLists()
        : file_(std::filesystem::path(testing::TempDir()) /
                ("palpate_nodes_" + std::to_string(getpid()) + ".txt")) {}
    ~NodeLists() override { std::filesystem::remove(file_); }

    std::string rule(const std::string& content) const {
        std::ofstream(file_) << content;
        return "nodes:" + file_.string();
    }
    std::filesystem::path file_;
};

TEST(NodeRules, a_surface_faces_a_way_within_45_degrees) {
    const auto middle_of_top_picked = [](double degrees) {
        TetMesh mesh = test::block_mesh({4, 4, 4}, {4, 4, 4});
        const Nodes middle = fixed(mesh, {"sphere:2,2,4,0.5"});
        for (Eigen::Vector3d& p : mesh.rest_positions)
            p.z() += p.y() * std::tan(degrees * std::numbers::pi / 180);
        const Nodes picked = fixed(mesh, {"facing:0,0,1"});
        return std::ranges::binary_search(picked, middle.at(0));
    };
    EXPECT_TRUE(middle_of_top_picked(40));
    EXPECT_FALSE(middle_of_top_picked(50));
}

TEST(NodeRules, every_kind_picks_the_surface_nodes_it_describes) {
    const TetMesh mesh = test::block_mesh({4, 4, 4}, {4, 4, 4});
    EXPECT_EQ(fixed(mesh, {"plane:0,0,0.5,0,0,-1"}).size(), 25U);
    EXPECT_EQ(fixed(mesh, {"sphere:0,0,0,1.2"}).size(), 4U);
    // Of a face its inside, and of its edges what looks that way as much as any other.
    const Nodes top = fixed(mesh, {"facing:0,0,2"});
    EXPECT_GE(top.size(), 9U);
    for (const std::int32_t node : top) EXPECT_EQ(mesh.rest_positions[node].z(), 4);
    for (const std::int32_t node : fixed(mesh, {"sphere:2,2,4,1.5"}))
        EXPECT_TRUE(std::ranges::binary_search(top, node) || mesh.rest_positions[node].z() < 4);
    // The whole block as a box: interior nodes stay free.
    EXPECT_EQ(fixed(mesh, {"box:-1,-1,-1,5,5,5"}).size(), 125U - 27U);
    EXPECT_EQ(fixed(mesh, {"sphere:0,0,0,0.5", "sphere:4,4,4,0.5"}), (Nodes{0, 124}));
}

TEST(NodeRules, touching_reads_what_lies_outside) {
    EXPECT_EQ(fixed(small_block(), {"touching:skull"}), (Nodes{5, 7}));
    EXPECT_EQ(fixed(small_block(), {"touching:background"}).size(), 24U);
}

TEST(NodeRules, a_region_is_the_surface_corners_of_its_tetrahedra) {
    // The cell has 8 corners; the one in the middle of the block is inside.
    EXPECT_EQ(fixed(small_block(), {"region:tumour"}), (Nodes{14, 16, 17, 22, 23, 25, 26}));
    EXPECT_EQ(fixed(small_block(), {"region:2"}), fixed(small_block(), {"region:tumour"}));
}

TEST(NodeRules, unknown_names_are_refused_with_the_nearest_ones) {
    const TetMesh mesh = small_block();
    EXPECT_NE(message([&] { fixed(mesh, {"touching:skul"}); }).find("--fixed touching:skul"),
              std::string::npos);
    EXPECT_NE(message([&] { fixed(mesh, {"touching:skul"}); }).find("labels that do: skull"),
              std::string::npos);
    EXPECT_NE(message([&] { touchable(mesh, {"region:tumor"}, {}); }).find("--contact region:tumor"),
              std::string::npos);
    EXPECT_NE(message([&] { touchable(mesh, {"region:tumor"}, {}); }).find("tumour"), std::string::npos);
    const TetMesh alone = test::block_mesh({1, 1, 1}, {1, 1, 1});
    EXPECT_NE(message([&] { fixed(alone, {"touching:skull"}); }).find("does not tell"), std::string::npos);
}

TEST(NodeRules, a_rule_that_picks_nothing_is_refused_though_others_pick_some) {
    EXPECT_NE(message([] {
                  fixed(small_block(), {"sphere:0,0,0,1", "sphere:50,0,0,1"});
              }).find("--fixed sphere:50,0,0,1: picks no node"),
              std::string::npos);
}

TEST(NodeRules, malformed_text_is_a_usage_error_that_quotes_it) {
    for (const auto& [text, found] : std::initializer_list<std::pair<std::string, std::string>>{
             {"", "is no rule"},
             {"touching:", "is no rule"},
             {"region:", "is no rule"},
             {"nodes:", "is no rule"},
             {"ball:1,2,3", "is no rule"},
             {"sphere", "'' is not a number"},
             {"sphere:1,2,3", "3 numbers (expected 4"},
             {"sphere:1,2,3,", "'' is not a number"},
             {"sphere:1,2,3,4,5", "5 numbers (expected 4"},
             {"sphere:1 2 3 4", "'1 2 3 4' is not a number"},
             {"sphere:1,2,3,0", "radius is not positive"},
             {"sphere:1,2,3,-4", "radius is not positive"},
             {"sphere:1,2,nan,4", "'nan' is not a number"},
             {"sphere:1,2,3,inf", "'inf' is not a number"},
             {"sphere:1-2,3,4,5", "'1-2' is not a number"},
             {"box:1,2,3,4,5,x", "'x' is not a number"},
             {"box:1,2,3,4,1,6", "not below its second"},
             {"plane:0,0,0,1,0,0,0", "7 numbers (expected 6"},
             {"plane:1,2,3,0,0,0", "normal has no length"},
             {"facing:0,1", "2 numbers (expected 3"},
             {"facing:0,0,0", "no length"}}) {
        EXPECT_THROW(parse_node_rule("--fixed", text), UsageError) << text;
        const std::string said = message([&] { parse_node_rule("--fixed", text); });
        EXPECT_NE(said.find(found), std::string::npos) << said;
        EXPECT_NE(said.find("--fixed"), std::string::npos) << said;
    }
}

TEST_F(NodeLists, name_nodes_one_a_line_with_comments) {
    EXPECT_EQ(fixed(small_block(), {rule("# the base\n7\n\n 3 # a corner\r\n7\n13")}), (Nodes{3, 7, 13}));
}

TEST_F(NodeLists, may_begin_with_a_byte_order_mark) {
    EXPECT_EQ(fixed(small_block(), {rule("\xef\xbb\xbf"
                                         "7\n3\n")}),
              (Nodes{3, 7}));
}

TEST_F(NodeLists, name_file_line_and_value_of_what_is_no_node) {
    const TetMesh mesh = small_block();
    for (const char* word : {"27", "-1", "4.0", "4 5", "four", "99999999999999999999"}) {
        const std::string said =
            message([&] { fixed(mesh, {rule("1\n# two\n" + std::string(word) + "\n")}); });
        EXPECT_NE(said.find(file_.string() + ":3: '" + word + "'"), std::string::npos) << said;
        EXPECT_NE(said.find("0 to 26"), std::string::npos) << said;
    }
}

TEST_F(NodeLists, without_a_node_or_a_file_are_refused) {
    const TetMesh mesh = small_block();
    EXPECT_NE(message([&] { fixed(mesh, {rule("# nothing\n")}); }).find("picks no node"), std::string::npos);
    const std::string missing = rule("") + ".not";
    EXPECT_NE(message([&] { fixed(mesh, {missing}); }).find("cannot be read"), std::string::npos);
    const std::string folder = "nodes:" + file_.parent_path().string();
    EXPECT_NE(message([&] { fixed(mesh, {folder}); }).find("is a folder"), std::string::npos);
    EXPECT_NE(message([&] { fixed(mesh, {"nodes:/dev/zero"}); }).find("is a device (expected a file)"),
              std::string::npos);
}

TEST_F(NodeLists, may_hold_interior_nodes_but_not_let_them_be_touched) {
    const TetMesh mesh = small_block();
    EXPECT_EQ(fixed(mesh, {rule("13\n")}), (Nodes{13}));
    EXPECT_EQ(touchable(mesh, {rule("12\n14\n")}, {}), (Nodes{12, 14}));
    const std::string said = message([&] { touchable(mesh, {rule("12\n13\n")}, {}); });
    EXPECT_NE(said.find(file_.string() + ":2: node 13 lies inside"), std::string::npos) << said;
}

TEST(ContactNodes, are_every_free_surface_node_without_a_rule) {
    const TetMesh mesh = small_block();
    const Nodes floor = fixed(mesh, {"plane:0,0,0,0,0,-1"});
    EXPECT_EQ(touchable(mesh, {}, floor).size(), 26U - 9U);
}

TEST(ContactNodes, are_what_any_rule_picks_without_the_fixed_ones) {
    const TetMesh mesh = small_block();
    const Nodes floor = fixed(mesh, {"plane:0,0,0,0,0,-1"});
    EXPECT_EQ(touchable(mesh, {"plane:0,0,0,-1,0,0"}, floor), (Nodes{9, 12, 15, 18, 21, 24}));
    EXPECT_EQ(touchable(mesh, {"sphere:0,0,2,0.5", "sphere:2,2,2,0.5"}, floor), (Nodes{18, 26}));
}

TEST(ContactNodes, that_are_all_fixed_are_refused) {
    const TetMesh mesh = small_block();
    const Nodes floor = fixed(mesh, {"plane:0,0,0,0,0,-1"});
    EXPECT_NE(message([&] {
                  touchable(mesh, {"sphere:0,0,0,1"}, {0, 1, 3, 9});
              }).find("every node picked is fixed"),
              std::string::npos);
}

TEST(ContactNodes, of_a_body_must_be_free_surface_nodes_in_order) {
    DeformableBody body =
        test::held_block({2, 2, 2}, {2, 2, 2}, {.youngs_modulus = 1, .poissons_ratio = 0.3});
    body.boundary = boundary_surface(body.mesh);
    EXPECT_EQ(contact_surface_of(body).size(), 17U);
    body.contact_nodes = {12, 26};
    EXPECT_EQ(contact_surface_of(body), (Nodes{12, 26}));
    for (const Nodes& wrong :
         {Nodes{12, 13}, Nodes{26, 12}, Nodes{12, 12}, Nodes{0, 12}, Nodes{12, 99}, Nodes{-1}}) {
        body.contact_nodes = wrong;
        EXPECT_THROW(contact_surface_of(body), InvalidInput) << wrong.front();
    }
}

}  // namespace
}  // namespace palpate
