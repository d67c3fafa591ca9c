// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <gtest/gtest.h>
#include <map>

#include "formats/elasticity/discretisation.hpp"
#include "formats/elasticity/sound_tetrahedra.hpp"
#include "tests/tools/fem/blocks.hpp"
#include "tools/fem/assembly/refinement.hpp"

namespace palpate {
namespace {

using namespace fem;

TetMesh jittered_block() {
    TetMesh mesh = test::block_mesh({2, 3, 2}, {4, 5, 6});
    test::jitter_interior(mesh, 0.3, 1);
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) mesh.regions[t] = 1 + static_cast<int>(t % 3);
    return mesh;
}

TEST(Refinement, cuts_each_tetrahedron_into_eight_of_an_eighth_of_its_volume_and_its_region) {
    const TetMesh mesh = jittered_block(), refined = refine_uniformly(mesh);
    ASSERT_EQ(refined.tetrahedra.size(), 8 * mesh.tetrahedra.size());
    ASSERT_EQ(refined.regions.size(), refined.tetrahedra.size());
    for (std::size_t t = 0; t < refined.tetrahedra.size(); ++t) {
        // Also oriented as it should be: the volume is positive.
        EXPECT_NEAR(six_volume(refined, t), six_volume(mesh, t / 8) / 8, 1e-14);
        EXPECT_EQ(refined.regions[t], mesh.regions[t / 8]);
    }
}

TEST(Refinement, every_diagonal_cuts_the_octahedron_into_parts_of_equal_volume) {
    // Stretched along one axis, a tetrahedron has each of the three diagonals as its shortest in turn.
    for (int axis = 0; axis < 3; ++axis) {
        Eigen::Vector3d stretch = Eigen::Vector3d::Ones();
        stretch[axis] = 0.2;
        TetMesh mesh;
        // Opposite edges of this tetrahedron are diagonals of a cube's sides, so their middles lie on the
        // axes.
        for (const Eigen::Vector3d& p : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 1, 0),
                                         Eigen::Vector3d(0, 1, 1), Eigen::Vector3d(1, 0, 1)})
            mesh.rest_positions.emplace_back(p.cwiseProduct(stretch));
        mesh.tetrahedra = {{0, 1, 2, 3}};
        mesh.regions = {1};
        if (six_volume(mesh, 0) < 0) std::swap(mesh.tetrahedra[0][2], mesh.tetrahedra[0][3]);
        const TetMesh refined = refine_uniformly(mesh);
        for (std::size_t t = 0; t < 8; ++t)
            EXPECT_NEAR(six_volume(refined, t), six_volume(mesh, 0) / 8, 1e-15);
        // The shortest diagonal is the one along the squeezed axis, and four parts share it.
        int sharing = 0;
        for (std::size_t t = 4; t < 8; ++t)
            for (const auto& [a, b] : elasticity::tetrahedron_edges) {
                const Eigen::Vector3d edge =
                    refined.rest_positions[static_cast<std::size_t>(refined.tetrahedra[t][a])] -
                    refined.rest_positions[static_cast<std::size_t>(refined.tetrahedra[t][b])];
                if (std::abs(std::abs(edge[axis]) - 0.2) < 1e-12 && std::abs(edge.norm() - 0.2) < 1e-12)
                    ++sharing;
            }
        EXPECT_EQ(sharing, 4);
    }
}

TEST(Refinement, keeps_old_nodes_and_numbers_middles_as_the_quadratic_discretisation) {
    const TetMesh mesh = jittered_block(), refined = refine_uniformly(mesh);
    const elasticity::Discretisation d = elasticity::discretise(mesh, ElementOrder::quadratic, {});
    ASSERT_EQ(refined.rest_positions.size(), d.node_count);
    for (std::size_t node = 0; node < mesh.rest_positions.size(); ++node)
        EXPECT_EQ(refined.rest_positions[node], mesh.rest_positions[node]);
    for (std::size_t e = 0; e < d.edges.size(); ++e) {
        const Eigen::Vector3d middle = (mesh.rest_positions[static_cast<std::size_t>(d.edges[e][0])] +
                                        mesh.rest_positions[static_cast<std::size_t>(d.edges[e][1])]) /
                                       2;
        EXPECT_EQ(refined.rest_positions[mesh.rest_positions.size() + e], middle);
    }
}

TEST(Refinement, keeps_the_mesh_conforming) {
    const TetMesh mesh = jittered_block(), refined = refine_uniformly(mesh);
    std::map<Triangle, int> uses;
    for (const Tetrahedron& tet : refined.tetrahedra)
        for (const auto& face : tetrahedron_faces) {
            Triangle key{tet[face[0]], tet[face[1]], tet[face[2]]};
            std::ranges::sort(key);
            ++uses[key];
        }
    const auto once = std::ranges::count_if(uses, [](const auto& face) { return face.second == 1; });
    EXPECT_TRUE(std::ranges::all_of(uses, [](const auto& face) { return face.second <= 2; }));
    EXPECT_EQ(static_cast<std::size_t>(once), 4 * boundary_surface(mesh).surface.triangles.size());
}

TEST(Refinement, gives_boundary_middles_the_lower_label_and_inner_ones_none) {
    TetMesh mesh = test::block_mesh({2, 2, 2}, {2, 2, 2});
    EXPECT_TRUE(refine_uniformly(mesh).outside_labels.empty());
    mesh.outside_labels.assign(mesh.rest_positions.size(), -1);
    for (const std::int32_t node : boundary_surface(mesh).nodes)
        mesh.outside_labels[static_cast<std::size_t>(node)] =
            mesh.rest_positions[static_cast<std::size_t>(node)].z() < 1e-9 ? 9 : 0;
    mesh.outside_names = {{9, "skull", {1, 1, 1}}};
    const TetMesh refined = refine_uniformly(mesh);
    ASSERT_EQ(refined.outside_labels.size(), refined.rest_positions.size());
    EXPECT_EQ(refined.outside_names.size(), 1U);
    for (std::size_t node = 0; node < refined.rest_positions.size(); ++node) {
        const auto p = refined.rest_positions[node].array();
        const bool inside = (p > 1e-9).all() && (p < 2 - 1e-9).all();
        EXPECT_EQ(refined.outside_labels[node], inside ? -1 : p.z() < 1e-9 ? 9 : 0) << node;
    }
}

TEST(Refinement, does_not_wear_tetrahedra_thin_when_repeated) {
    TetMesh mesh = jittered_block();
    const auto worst = [](const TetMesh& of) {
        double quality = 1;
        for (std::size_t t = 0; t < of.tetrahedra.size(); ++t)
            quality = std::min(quality, elasticity::element_quality(of, t));
        return quality;
    };
    const TetMesh once = refine_uniformly(mesh);
    const double first = worst(once);
    EXPECT_NEAR(worst(refine_uniformly(refine_uniformly(once))), first, 0.5 * first);
}

}  // namespace
}  // namespace palpate
