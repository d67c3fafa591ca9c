// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "tests/tools/meshing/cube_mesh.hpp"
#include "tests/tools/meshing/phantom.hpp"
#include "tools/meshing/measures/quality.hpp"
#include "tools/meshing/tetrahedra/body_repair.hpp"
#include "tools/meshing/tetrahedra/lift_flat_tetrahedra.hpp"
#include "tools/meshing/tetrahedra/tetrahedralise.hpp"

namespace palpate {
namespace {

using namespace meshing;

// Two tetrahedra that share node 0 only, or the edge 0-1.
TetMesh hinged(bool at_edge) {
    TetMesh mesh;
    mesh.rest_positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}};
    mesh.tetrahedra = {{0, 1, 2, 3}, at_edge ? Tetrahedron{0, 1, 5, 6} : Tetrahedron{0, 4, 6, 5}};
    mesh.regions = {1, 1};
    return mesh;
}

TEST(SplitHinges, pieces_that_share_a_point_or_an_edge_are_parted) {
    for (const bool at_edge : {false, true}) {
        TetMesh mesh = hinged(at_edge);
        const MeshQuality before = measure(mesh);
        EXPECT_EQ(before.boundary.non_manifold_edges, at_edge ? 1 : 0);
        EXPECT_EQ(split_hinges(mesh), at_edge ? 2 : 1);
        const MeshQuality after = measure(mesh);
        EXPECT_TRUE(after.boundary.closed_and_oriented());
        EXPECT_EQ(after.boundary.components, 2);
        EXPECT_DOUBLE_EQ(after.region_volumes[0].volume, before.region_volumes[0].volume);
        EXPECT_EQ(split_hinges(mesh), 0);
    }
}

TEST(RemoveCrumbs, only_small_pieces_go_and_every_node_stays_used) {
    TetMesh mesh = hinged(false);
    for (const std::size_t node : {4U, 5U, 6U}) mesh.rest_positions[node] *= 0.5;  // 1/48 mm³ beside 1/6
    split_hinges(mesh);
    EXPECT_EQ(remove_crumbs(mesh, 0.1), 1);
    EXPECT_EQ(mesh.tetrahedra.size(), 1U);
    EXPECT_EQ(mesh.rest_positions.size(), 4U);
    EXPECT_EQ(remove_crumbs(mesh, 0.1), 0);
}

// Three layers of 2 x 2 cubes; the middle one lacks two that are diagonal, so that the others meet in an
// edge.
TetMesh pinched() {
    TetMesh mesh;
    const auto node = [](int i, int j, int k) { return (k * 3 + j) * 3 + i; };
    for (int k = 0; k <= 3; ++k)
        for (int j = 0; j <= 2; ++j)
            for (int i = 0; i <= 2; ++i) mesh.rest_positions.emplace_back(i, j, k);
    for (int k = 0; k < 3; ++k)
        for (int j = 0; j < 2; ++j)
            for (int i = 0; i < 2; ++i)
                if (k != 1 || i != j) test::add_cube(mesh, {i, j, k}, 1, node);
    return mesh;
}

TEST(AbsorbIslands, small_island_goes_to_the_region_around_it_and_the_largest_stays) {
    TetMesh mesh = pinched();
    for (std::size_t t = 0; t < 6; ++t) mesh.regions[t] = 2;  // a cube
    mesh.regions.back() = 2;                                  // a lone tetrahedron elsewhere
    EXPECT_EQ(absorb_islands(mesh, 0.5), 1);
    EXPECT_EQ(mesh.regions.back(), 1);
    EXPECT_EQ(std::ranges::count(mesh.regions, 2), 6);
    EXPECT_EQ(absorb_islands(mesh, 100), 0);  // each region's only piece
}

TEST(RemoveCrumbs, last_piece_of_a_region_stays) {
    TetMesh mesh = hinged(false);
    mesh.regions = {1, 2};
    split_hinges(mesh);
    EXPECT_EQ(remove_crumbs(mesh, 100), 0);
    EXPECT_EQ(mesh.tetrahedra.size(), 2U);
}

TEST(PartPinchedEdges, no_edge_is_left_in_more_than_two_boundary_faces) {
    TetMesh mesh = pinched();
    ASSERT_EQ(split_hinges(mesh), 0);  // the other layers hold the corners together
    const MeshQuality before = measure(mesh);
    ASSERT_EQ(before.boundary.non_manifold_edges, 1);
    const std::int64_t removed = part_pinched_edges(mesh);
    const MeshQuality after = measure(mesh);
    EXPECT_TRUE(after.boundary.closed_and_oriented());
    EXPECT_GT(removed, 0);
    EXPECT_LE(removed, 6);  // no more than one of the six cubes
    EXPECT_EQ(part_pinched_edges(mesh), 0);
}

TEST(LiftFlatTetrahedra, sliver_in_the_middle_of_a_ball_becomes_sound) {
    const LabelMap map = test::organ_with_lesion();
    TetMesh mesh = tetrahedralise(map, test::organ_and_lesion, {.cell_size = 5});
    // Push one interior node nearly through the opposite face of one of its tetrahedra.
    const std::size_t node =
        static_cast<std::size_t>(std::ranges::find(mesh.outside_labels, -1) - mesh.outside_labels.begin());
    for (const Tetrahedron& tet : mesh.tetrahedra) {
        const auto corner = std::ranges::find(tet, static_cast<std::int32_t>(node));
        if (corner == tet.end()) continue;
        Eigen::Vector3d face = Eigen::Vector3d::Zero();
        for (const std::int32_t other : tet)
            if (static_cast<std::size_t>(other) != node)
                face += mesh.rest_positions[static_cast<std::size_t>(other)] / 3;
        mesh.rest_positions[node] += 0.97 * (face - mesh.rest_positions[node]);
        break;
    }
    const MeshQuality flat = measure(mesh);
    ASSERT_EQ(flat.inverted, 0);
    ASSERT_LT(flat.min_dihedral_deg, 5);
    lift_flat_tetrahedra(mesh, 15, 0.5);
    EXPECT_GE(measure(mesh).min_dihedral_deg, 12);
}

TEST(LiftFlatTetrahedra, surface_nodes_stay_near_their_tangent_planes) {
    TetMesh mesh;
    mesh.rest_positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0.02}};
    mesh.tetrahedra = {{0, 1, 2, 3}};
    mesh.regions = {1};
    const std::vector<Eigen::Vector3d> before = mesh.rest_positions;
    const double flatness = flatness_deg(mesh, 0), reach = 0.05;
    lift_flat_tetrahedra(mesh, 30, reach);
    EXPECT_GT(flatness_deg(mesh, 0), flatness);
    for (std::size_t node = 0; node < 4; ++node)
        EXPECT_LE((mesh.rest_positions[node] - before[node]).norm(), std::sqrt(17.0) * reach);  // 1² + 4²
}

}  // namespace
}  // namespace palpate
