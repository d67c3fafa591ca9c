// SPDX-License-Identifier: Apache-2.0
// What a file must not claim, though each of its digests is right.
#include <algorithm>
#include <cmath>
#include <functional>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <limits>
#include <span>
#include <variant>

#include "formats/asset/asset.hpp"
#include "formats/asset/parts.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/formats/scratch.hpp"
#include "tests/formats/unchecked_body.hpp"

namespace palpate {
namespace {

using namespace asset;
using sample::cells;
using sample::hierarchical_cube;
using sample::refusal;
using sample::Scratch;
using sample::write_unchecked;
using ::testing::HasSubstr;

struct Fault {
    const char* name;
    std::function<void(DeformableBody&)> make;
    const char* message;
};

void PrintTo(const Fault& fault, std::ostream* stream) {
    *stream << fault.name;
}

class FaultyBody : public ::testing::TestWithParam<Fault> {};

TEST_P(FaultyBody, is_refused_though_its_digests_are_right) {
    const Scratch scratch;
    DeformableBody body = sample::elastic_cube(cells);
    GetParam().make(body);
    write_unchecked(scratch / "faulty.body.h5", body);
    const std::string message = refusal([&] { read_body_part(scratch / "faulty.body.h5"); });
    EXPECT_THAT(message, HasSubstr("faulty.body.h5: /palpate/body"));
    EXPECT_THAT(message, HasSubstr(GetParam().message));
}

void set_entry(DeformableBody& body, std::size_t row, std::size_t column, float value) {
    const_cast<float*>(std::get<DenseCompliance>(body.compliance).row(row))[column] = value;
}

// A tetrahedron beside the cube that hangs together with nothing.
void add_island(DeformableBody& body) {
    TetMesh& mesh = body.mesh;
    const auto first = static_cast<std::int32_t>(mesh.rest_positions.size());
    for (const Eigen::Vector3d& corner : {Eigen::Vector3d(60, 0, 0), Eigen::Vector3d(62, 0, 0),
                                          Eigen::Vector3d(60, 2, 0), Eigen::Vector3d(60, 0, 2)})
        mesh.rest_positions.push_back(corner);
    mesh.tetrahedra.push_back({first, first + 1, first + 2, first + 3});
    mesh.regions.push_back(mesh.regions[0]);
    if (!mesh.outside_labels.empty()) mesh.outside_labels.resize(mesh.rest_positions.size(), 0);
    body.boundary = boundary_surface(mesh);
}

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

INSTANTIATE_TEST_SUITE_P(
    Each, FaultyBody,
    ::testing::Values(
        Fault{"position_nan", [](auto& b) { b.mesh.rest_positions[3].y() = nan; }, "rest_positions: point 3"},
        Fault{"position_far", [](auto& b) { b.mesh.rest_positions[3].y() = 1e6; },
              "rest_positions: point 3 is not finite or far from any patient"},
        Fault{"tet_index_negative", [](auto& b) { b.mesh.tetrahedra[5][1] = -1; },
              "tetrahedra: entry 5 has index -1"},
        Fault{"tet_index_large", [](auto& b) { b.mesh.tetrahedra[5][1] = 125; },
              "tetrahedra: entry 5 has index 125"},
        Fault{"tet_inverted", [](auto& b) { std::swap(b.mesh.tetrahedra[0][0], b.mesh.tetrahedra[0][1]); },
              "tetrahedron 0 is flat or inside out"},
        Fault{"tet_three_times",
              [](auto& b) {
                  const std::size_t inner = b.mesh.tetrahedra.size() / 2;
                  for (int i = 0; i < 2; ++i) {
                      b.mesh.tetrahedra.push_back(b.mesh.tetrahedra[inner]);
                      b.mesh.regions.push_back(b.mesh.regions[inner]);
                  }
                  b.boundary = boundary_surface(b.mesh);
              },
              "tetrahedra: a face is of three tetrahedra or more"},
        Fault{"node_of_nothing",
              [](auto& b) {
                  b.mesh.rest_positions.emplace_back(1, 2, 3);
                  b.mesh.outside_labels.push_back(-1);
              },
              "tetrahedra: node 125 belongs to none of them"},
        Fault{"part_that_nothing_holds", [](auto& b) { add_island(b); },
              "fixed_nodes: the part of the body with node 125 is not held"},
        Fault{"held_by_two_nodes", [](auto& b) { b.fixed_nodes.resize(2); },
              "is not held (expected 3 fixed nodes or more)"},
        Fault{"modulus_that_overflows", [](auto& b) { b.materials[0].material.youngs_modulus = 1e-300; },
              "youngs_modulus of region 1 is 0.000000 N/mm² (expected 1e-06 to 2e+06)"},
        Fault{"regions_short", [](auto& b) { b.mesh.regions.pop_back(); },
              "regions: 383 values (expected 384)"},
        Fault{"region_unnamed", [](auto& b) { b.mesh.regions[0] = 9; }, "region_names: does not name"},
        Fault{"region_name_control", [](auto& b) { b.mesh.region_names[0].name = "a\x1b[2J"; },
              "not printable"},
        Fault{"region_name_no_utf8", [](auto& b) { b.mesh.region_names[0].name = "\xff\xfe"; },
              "not printable"},
        Fault{"region_name_overlong", [](auto& b) { b.mesh.region_names[0].name = "\xc0\xaf"; },
              "not printable"},
        Fault{"region_name_surrogate", [](auto& b) { b.mesh.region_names[0].name = "\xed\xa0\x80"; },
              "not printable"},
        Fault{"region_name_c1", [](auto& b) { b.mesh.region_names[0].name = "a\xc2\x9b"; }, "not printable"},
        Fault{"region_name_bidi", [](auto& b) { b.mesh.region_names[0].name = "a\xe2\x80\xae"; },
              "not printable"},
        Fault{"region_name_cut", [](auto& b) { b.mesh.region_names[0].name = "a\xe2\x80"; }, "not printable"},
        Fault{"region_name_empty", [](auto& b) { b.mesh.region_names[0].name = ""; }, "empty"},
        Fault{"label_value_zero", [](auto& b) { b.mesh.outside_names[0].value = 0; }, "label value 0"},
        Fault{"colour_nan", [](auto& b) { b.mesh.region_names[0].colour[1] = NAN; }, "colour"},
        Fault{"outside_short", [](auto& b) { b.mesh.outside_labels.pop_back(); },
              "outside_labels: 124 values"},
        Fault{"outside_unnamed", [](auto& b) { b.mesh.outside_labels[0] = 8; }, "value 8 has no name"},
        Fault{"material_missing", [](auto& b) { b.materials.pop_back(); }, "one material for each region"},
        Fault{"modulus_zero", [](auto& b) { b.materials[0].material.youngs_modulus = 0; },
              "youngs_modulus of region"},
        Fault{"modulus_nan", [](auto& b) { b.materials[0].material.youngs_modulus = nan; },
              "youngs_modulus of region"},
        Fault{"poisson_half", [](auto& b) { b.materials[0].material.poissons_ratio = 0.5; },
              "poissons_ratio of region"},
        Fault{"relaxation_share_one",
              [](auto& b) {
                  b.relaxation = {{1, {1, 1}}};
              },
              "relaxation: share of region 1 is 1.0"},
        Fault{"relaxation_time_nan",
              [](auto& b) {
                  b.relaxation = {{1, {0.3, nan}}};
              },
              "relaxation: time of region 1 is nan"},
        Fault{"relaxation_whole",
              [](auto& b) {
                  b.relaxation = {{2, {0.5, 1}}, {2, {0.5, 2}}};
              },
              "in all terms together (expected 0.9999 at most)"},
        Fault{"relaxation_times_equal",
              [](auto& b) {
                  b.relaxation = {{2, {0.5, 1}}, {2, {0.2, 1}}};
              },
              "ascending times"},
        Fault{"relaxation_of_no_region",
              [](auto& b) {
                  b.relaxation = {{3, {0.5, 1}}};
              },
              "a term of region 3 that the mesh does not have"},
        Fault{"relaxation_unsorted", [](auto& b) { b.relaxation = {{2, {0.5, 1}}, {1, {0.2, 1}}}; },
              "is not in the order of its regions"},
        Fault{"relaxation_many", [](auto& b) { b.relaxation.assign(9, {1, {0.01, 1}}); },
              "relaxation: has 9 terms (expected 8 at most)"},
        Fault{"fixed_unsorted", [](auto& b) { std::swap(b.fixed_nodes[0], b.fixed_nodes[1]); },
              "fixed_nodes: entry 1"},
        Fault{"fixed_range", [](auto& b) { b.fixed_nodes.back() = 125; }, "fixed_nodes: entry"},
        Fault{"fixed_none", [](auto& b) { b.fixed_nodes.clear(); }, "fixed_nodes: is empty"},
        Fault{
            "surface_turned",
            [](auto&
                   b) { std::swap(b.boundary.surface.triangles[0][0], b.boundary.surface.triangles[0][1]); },
            "is not the boundary"},
        Fault{"surface_node_range", [](auto& b) { b.boundary.nodes[0] = 1'000'000; },
              "surface_nodes: has index 1000000"},
        Fault{"contact_fixed", [](auto& b) { b.contact_nodes[0] = b.fixed_nodes[0]; },
              "contact_nodes: node 0 is not free surface"},
        Fault{"contact_inside", [](auto& b) { b.contact_nodes[6] = 31; },
              "contact_nodes: node 31 is not free surface"},
        Fault{"contact_unsorted", [](auto& b) { std::swap(b.contact_nodes[0], b.contact_nodes[1]); },
              "contact_nodes: entry 1"},
        Fault{"contact_twice", [](auto& b) { b.contact_nodes[1] = b.contact_nodes[0]; },
              "contact_nodes: entry 1"},
        Fault{"contact_range", [](auto& b) { b.contact_nodes.back() = 125; }, "contact_nodes: entry"},
        Fault{"compliance_nan", [](auto& b) { set_entry(b, 7, 2, NAN); },
              "compliance: has an entry that is not finite"},
        Fault{"compliance_infinite", [](auto& b) { set_entry(b, 7, 2, INFINITY); }, "not finite"},
        Fault{"compliance_diagonal", [](auto& b) { set_entry(b, 7, 7, 0); },
              "diagonal entry 7 is not positive"},
        Fault{"compliance_size", [](auto& b) { --std::get<DenseCompliance>(b.compliance).node_count; },
              "compliance/dense: is float32"},
        Fault{"element_order_unknown", [](auto& b) { b.element_order = static_cast<ElementOrder>(3); },
              "has element_order 3 (expected 1 (linear) or 2 (quadratic))"},
        Fault{"certificate_nan", [](auto& b) { b.certificate.residual = nan; }, "certificate: residual is"}),
    [](const auto& info) { return std::string(info.param.name); });

struct BlockFault {
    const char* name;
    std::function<void(HierarchicalCompliance&)> make;
    const char* message;
};

void PrintTo(const BlockFault& fault, std::ostream* stream) {
    *stream << fault.name;
}

class FaultyBlocks : public ::testing::TestWithParam<BlockFault> {};

TEST_P(FaultyBlocks, are_refused_though_their_digests_are_right) {
    const Scratch scratch;
    DeformableBody body = hierarchical_cube();
    GetParam().make(std::get<HierarchicalCompliance>(body.compliance));
    write_unchecked(scratch / "faulty.body.h5", body);
    const std::string message = refusal([&] { read_body_part(scratch / "faulty.body.h5"); });
    EXPECT_THAT(message, HasSubstr("faulty.body.h5: /palpate/body/compliance"));
    EXPECT_THAT(message, HasSubstr(GetParam().message));
    // Except for lengths, which arrays in memory do not have, a writer refuses it too.
    if (GetParam().message != std::string("compliance/order: is int32")) {
        EXPECT_THAT(refusal([&] { write_body_part(scratch / "unwritten.body.h5", body); }),
                    HasSubstr(GetParam().message));
    }
}

ComplianceBlock& first_of_low_rank(HierarchicalCompliance& c) {
    return *std::ranges::find_if(c.blocks, [](const auto& b) { return b.first_child == 0 && b.rank > 0; });
}

// The first block that is stored dense at the last level couples a cluster with itself.
ComplianceBlock& first_dense(HierarchicalCompliance& c) {
    return *std::ranges::find_if(
        c.blocks, [](const auto& b) { return b.first_child == 0 && b.rank == ComplianceBlock::dense; });
}

float& value_of(HierarchicalCompliance& c, const ComplianceBlock& block, std::int64_t i) {
    return const_cast<float&>(c.values.get()[block.values + i]);
}

constexpr std::int64_t farthest = std::numeric_limits<std::int64_t>::max();
constexpr std::int64_t nearest = std::numeric_limits<std::int64_t>::min();

// Blocks 0 to 3 are the whole, (0,0), (1,0) and (1,1), all of them split.
INSTANTIATE_TEST_SUITE_P(
    Each, FaultyBlocks,
    ::testing::Values(
        BlockFault{"depth_negative", [](auto& c) { c.depth = -1; }, "has depth -1"},
        BlockFault{"depth_large", [](auto& c) { c.depth = 21; }, "has depth 21"},
        BlockFault{"depth_of_empty_clusters", [](auto& c) { c.depth = 7; }, "has depth 7"},
        BlockFault{"depth_less_than_the_tree", [](auto& c) { c.depth = 2; }, "has parts out of place"},
        BlockFault{"accuracy_nan", [](auto& c) { c.accuracy = std::nan(""); }, "accuracy"},
        BlockFault{"accuracy_zero", [](auto& c) { c.accuracy = 0; }, "accuracy"},
        BlockFault{"accuracy_infinite", [](auto& c) { c.accuracy = INFINITY; }, "accuracy"},
        BlockFault{"order_short", [](auto& c) { c.order.pop_back(); }, "compliance/order: is int32"},
        BlockFault{"order_repeats", [](auto& c) { c.order[0] = c.order[1]; }, "order: is not a permutation"},
        BlockFault{"order_negative", [](auto& c) { c.order[0] = -1; }, "order: is not a permutation"},
        BlockFault{"order_large", [](auto& c) { c.order[0] = 73; }, "order: is not a permutation"},
        BlockFault{"blocks_none", [](auto& c) { c.blocks.clear(); }, "has blocks out of place"},
        BlockFault{"parts_before_whole", [](auto& c) { c.blocks[3].first_child = 1; },
                   "block 3 has parts out of place"},
        BlockFault{"part_of_itself", [](auto& c) { c.blocks[3].first_child = 3; },
                   "block 3 has parts out of place"},
        BlockFault{"parts_negative", [](auto& c) { c.blocks[3].first_child = -4; },
                   "block 3 has parts out of place"},
        BlockFault{"parts_beyond", [](auto& c) { c.blocks[3].first_child = 1 << 30; },
                   "has blocks out of place"},
        BlockFault{"parts_shared", [](auto& c) { c.blocks[3].first_child = c.blocks[1].first_child; },
                   "has blocks out of place"},
        BlockFault{"parts_of_the_smallest", [](auto& c) { first_dense(c).first_child = 1 << 20; },
                   "has parts out of place"},
        BlockFault{"block_of_nothing", [](auto& c) { c.blocks.push_back(c.blocks.back()); },
                   "has blocks that belong to nothing"},
        BlockFault{"split_block_stored", [](auto& c) { c.blocks[1].first_child = 0; },
                   "lies outside the values"},
        BlockFault{"rank_not_of_fours", [](auto& c) { first_of_low_rank(c).rank -= 1; }, "has rank"},
        BlockFault{"rank_negative", [](auto& c) { first_of_low_rank(c).rank = -4; }, "has rank -4"},
        BlockFault{"rank_large", [](auto& c) { first_of_low_rank(c).rank = 1028; }, "has rank 1028"},
        BlockFault{"rank_of_a_diagonal_block", [](auto& c) { first_dense(c).rank = 4; }, "has rank 4"},
        BlockFault{"rank_0_of_a_diagonal_block", [](auto& c) { first_dense(c).rank = 0; }, "has rank 0"},
        BlockFault{"rank_beyond_the_values", [](auto& c) { first_of_low_rank(c).rank = 1024; },
                   "lies outside the values"},
        BlockFault{
            "values_beyond",
            [](auto& c) { first_of_low_rank(c).values = static_cast<std::int64_t>(c.value_count) - 3; },
            "lies outside the values"},
        BlockFault{"values_negative", [](auto& c) { first_dense(c).values = -1; }, "lies outside the values"},
        BlockFault{"values_farthest", [](auto& c) { first_dense(c).values = farthest; },
                   "lies outside the values"},
        BlockFault{"values_nearest", [](auto& c) { first_dense(c).values = nearest; },
                   "lies outside the values"},
        BlockFault{
            "factors_beyond",
            [](auto& c) { first_of_low_rank(c).factors = static_cast<std::int64_t>(c.factor_count) - 3; },
            "lies outside the values"},
        BlockFault{"factors_negative", [](auto& c) { first_of_low_rank(c).factors = -1; },
                   "lies outside the values"},
        BlockFault{"factors_farthest", [](auto& c) { first_of_low_rank(c).factors = farthest; },
                   "lies outside the values"},
        BlockFault{"factors_nearest", [](auto& c) { first_of_low_rank(c).factors = nearest; },
                   "lies outside the values"},
        BlockFault{"values_cut", [](auto& c) { --c.value_count; }, "lies outside the values"},
        BlockFault{"factors_cut", [](auto& c) { --c.factor_count; }, "lies outside the values"},
        BlockFault{"entry_nan", [](auto& c) { value_of(c, first_dense(c), 1) = NAN; },
                   "values: has an entry that is not finite"},
        BlockFault{"scale_infinite", [](auto& c) { value_of(c, first_of_low_rank(c), 0) = INFINITY; },
                   "values: has an entry that is not finite"},
        BlockFault{"diagonal_zero", [](auto& c) { value_of(c, first_dense(c), 0) = 0; }, "is not positive"},
        BlockFault{"diagonal_negative", [](auto& c) { value_of(c, first_dense(c), 0) = -1; },
                   "is not positive"}),
    [](const auto& info) { return std::string(info.param.name); });

TEST(Parts, a_compliance_in_both_forms_is_refused) {
    const Scratch scratch;
    const DeformableBody dense = sample::elastic_cube(cells), blocks = hierarchical_cube();
    const auto& entries = std::get<DenseCompliance>(dense.compliance);
    const std::size_t dofs = entries.dof_count();
    {
        Hdf5Writer writer(scratch / "both.body.h5");
        write_header(writer, "body");
        write_condensed_body(writer, "/palpate/body", blocks, mechanics_digest(blocks));
        writer.dataset("/palpate/body/compliance/dense", std::span(entries.entries.get(), dofs * dofs),
                       {dofs, dofs}, "mm/N");
        writer.finish("/palpate");
    }
    EXPECT_THAT(refusal([&] { read_body_part(scratch / "both.body.h5"); }),
                HasSubstr("both.body.h5: /palpate/body/compliance: is both dense and hierarchical"));
}

TEST(Asset, a_compliance_in_neither_form_is_refused) {
    const Scratch scratch;
    const auto path = scratch / "neither.vtkhdf";
    write_asset(path, sample::sample_case(cells));
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110);
    const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, access);
    H5Ldelete(file, "/palpate/bodies/deformable/0/compliance/dense", H5P_DEFAULT);
    H5Fclose(file);
    H5Pclose(access);
    EXPECT_THAT(refusal([&] { read_asset(path, Digests::skip); }),
                HasSubstr("deformable/0/compliance: is neither dense nor hierarchical"));
}

struct TreeFault {
    const char* name;
    std::function<void(ObbTree&)> make;
    const char* message;
};

void PrintTo(const TreeFault& fault, std::ostream* stream) {
    *stream << fault.name;
}

class FaultyTree : public ::testing::TestWithParam<TreeFault> {};

TEST_P(FaultyTree, is_refused_though_its_digests_are_right) {
    const Scratch scratch;
    const TriangleMesh sphere = sample::sphere_surface({0, 0, 0}, 10, 2);
    ObbTree tree = sample::median_tree(sphere, 2);
    GetParam().make(tree);
    Hdf5Writer writer(scratch / "faulty.obb.h5");
    write_header(writer, "obb_tree");
    write_obb_tree(writer, "/palpate/obb_tree", tree, sphere);
    writer.finish("/palpate");
    EXPECT_THAT(refusal([&] { read_obb_part(scratch / "faulty.obb.h5", sphere); }),
                HasSubstr(GetParam().message));
}

ObbNode& first_leaf(ObbTree& tree) {
    return *std::ranges::find_if(tree.nodes, [](const ObbNode& node) { return node.count > 0; });
}

// A list of leaves of one triangle each hanging off a spine: as deep as a binary tree can be.
void make_spine(ObbTree& tree) {
    const ObbNode box = tree.nodes[0];
    const auto triangles = static_cast<std::int32_t>(tree.triangle_order.size());
    tree.nodes.assign(1, box);
    for (std::int32_t t = 0; t + 1 < triangles; ++t) {
        tree.nodes.back().first = static_cast<std::int32_t>(tree.nodes.size());
        tree.nodes.back().count = 0;
        tree.nodes.push_back(box);
        tree.nodes.back().first = t;
        tree.nodes.back().count = 1;
        tree.nodes.push_back(box);
    }
    tree.nodes.back().first = triangles - 1;
    tree.nodes.back().count = 1;
}

INSTANTIATE_TEST_SUITE_P(
    Each, FaultyTree,
    ::testing::Values(
        TreeFault{"empty", [](auto& t) { t.nodes.clear(); }, "has no nodes"},
        TreeFault{"order_short", [](auto& t) { t.triangle_order.pop_back(); }, "127 entries (expected 128)"},
        TreeFault{"order_repeats", [](auto& t) { t.triangle_order[0] = t.triangle_order[1]; },
                  "not a permutation"},
        TreeFault{"order_range", [](auto& t) { t.triangle_order[0] = -5; }, "not a permutation"},
        TreeFault{"cycle", [](auto& t) { t.nodes[1].first = 0; }, "children out of place"},
        TreeFault{"self", [](auto& t) { t.nodes[1].first = 1; }, "children out of place"},
        TreeFault{"children_shared", [](auto& t) { t.nodes[2].first = t.nodes[1].first; },
                  "children out of place"},
        TreeFault{"children_beyond", [](auto& t) { t.nodes[0].first = 1 << 30; }, "children out of place"},
        TreeFault{"orphan", [](auto& t) { t.nodes.push_back(t.nodes.back()); }, "has no parent"},
        TreeFault{"leaf_beyond", [](auto& t) { first_leaf(t).first = 1 << 30; }, "beyond the last"},
        TreeFault{"leaf_overlaps", [](auto& t) { first_leaf(t).first += 1; }, "shares a triangle"},
        TreeFault{"leaf_short", [](auto& t) { first_leaf(t).count -= 1; }, "leaves out triangles"},
        TreeFault{"count_negative", [](auto& t) { first_leaf(t).count = -1; }, "negative range"},
        TreeFault{"axes_skewed", [](auto& t) { t.nodes[3].axes(0, 1) = 0.5F; },
                  "box 3 is not an oriented box"},
        TreeFault{"axes_nan", [](auto& t) { t.nodes[3].axes(0, 1) = NAN; }, "box 3 is not an oriented box"},
        TreeFault{"center_infinite", [](auto& t) { t.nodes[3].center[1] = INFINITY; },
                  "box 3 is not an oriented box"},
        TreeFault{"extents_large", [](auto& t) { t.nodes[3].half_extents[1] += 2; }, "mm too large"},
        TreeFault{"extents_negative", [](auto& t) { t.nodes[3].half_extents[1] = -1; },
                  "box 3 is not an oriented box"},
        TreeFault{"too_deep", make_spine, "is too deep"}),
    [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace palpate
