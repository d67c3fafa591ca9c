// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "formats/model/errors.hpp"
#include "tests/tools/meshing/cube_mesh.hpp"
#include "tests/tools/meshing/phantom.hpp"
#include "tools/meshing/contract/fidelity.hpp"
#include "tools/meshing/measures/quality.hpp"

namespace palpate {
namespace {

using namespace meshing;

constexpr double rounding = 1e-12;

TetMesh one_tetrahedron(std::vector<Eigen::Vector3d> corners) {
    TetMesh mesh;
    mesh.rest_positions = std::move(corners);
    mesh.tetrahedra = {{0, 1, 2, 3}};
    mesh.regions = {1};
    return mesh;
}

// A box of unit cubes, each cut into six tetrahedra around its diagonal.
TetMesh box(int nx, int ny, int nz) {
    TetMesh mesh;
    const auto node = [&](int i, int j, int k) { return (k * (ny + 1) + j) * (nx + 1) + i; };
    for (int k = 0; k <= nz; ++k)
        for (int j = 0; j <= ny; ++j)
            for (int i = 0; i <= nx; ++i) mesh.rest_positions.emplace_back(i, j, k);
    for (int k = 0; k < nz; ++k)
        for (int j = 0; j < ny; ++j)
            for (int i = 0; i < nx; ++i) test::add_cube(mesh, {i, j, k}, i < nx / 2 ? 4 : 9, node);
    return mesh;
}

TEST(MeshQuality, regular_tetrahedron_has_equal_angles_and_ratio_one) {
    const MeshQuality quality = measure(one_tetrahedron({{1, 1, 1}, {1, -1, -1}, {-1, -1, 1}, {-1, 1, -1}}));
    const double dihedral = std::acos(1.0 / 3) * 180 / std::numbers::pi;
    EXPECT_NEAR(quality.min_dihedral_deg, dihedral, 1e-10);
    EXPECT_NEAR(quality.max_dihedral_deg, dihedral, 1e-10);
    EXPECT_NEAR(quality.min_radius_ratio, 1, rounding);
    EXPECT_EQ(quality.dihedral_histogram[7], 6);
    EXPECT_NEAR(quality.region_volumes[0].volume, 8.0 / 3, rounding);
    EXPECT_EQ(quality.inverted, 0);
}

TEST(MeshQuality, corner_tetrahedron_has_the_angles_of_a_hand_calculation) {
    // Three right angles at the corner's edges; the others are atan(sqrt 2).
    const MeshQuality quality = measure(one_tetrahedron({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
    EXPECT_NEAR(quality.min_dihedral_deg, std::atan(std::sqrt(2.0)) * 180 / std::numbers::pi, 1e-10);
    EXPECT_NEAR(quality.max_dihedral_deg, 90, 1e-10);
    // r = 1 / (3 + sqrt 3), R = sqrt 3 / 2.
    EXPECT_NEAR(quality.min_radius_ratio, 3 / (3 + std::sqrt(3.0)) / (std::sqrt(3.0) / 2), rounding);
}

TEST(MeshQuality, flat_and_inverted_tetrahedra_are_counted) {
    const TetMesh inverted = one_tetrahedron({{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}});
    EXPECT_EQ(measure(inverted).inverted, 1);
    EXPECT_EQ(measure(inverted).min_radius_ratio, 0);
    const TetMesh flat = one_tetrahedron({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 1e-6}});
    EXPECT_LT(measure(flat).min_dihedral_deg, 1e-3);
    EXPECT_EQ(measure(flat).worst.at(0).tetrahedron, 0);
    EXPECT_LT(flatness_deg(flat, 0), 1e-3);
}

TEST(MeshQuality, box_has_the_volumes_and_the_boundary_of_a_box) {
    const MeshQuality quality = measure(box(4, 3, 2));
    ASSERT_EQ(quality.region_volumes.size(), 2U);
    EXPECT_NEAR(quality.region_volumes[0].volume, 12, 1e-10);
    EXPECT_NEAR(quality.region_volumes[1].volume, 12, 1e-10);
    EXPECT_EQ(quality.inverted, 0);
    EXPECT_EQ(quality.components, 1);
    EXPECT_TRUE(quality.boundary.closed_and_oriented());
    EXPECT_NEAR(quality.boundary.area, 2 * (12 + 8 + 6), 1e-10);
    EXPECT_NEAR(quality.boundary.volume, 24, 1e-10);
}

TEST(MeshQuality, pieces_that_meet_in_a_point_are_two) {
    TetMesh mesh = one_tetrahedron({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
    mesh.rest_positions.insert(mesh.rest_positions.end(), {{-1, 0, 0}, {0, 0, -1}, {0, -1, 0}});
    mesh.tetrahedra.push_back({0, 4, 5, 6});
    mesh.regions.push_back(1);
    EXPECT_EQ(measure(mesh).components, 2);
    EXPECT_EQ(face_components(mesh), (std::vector<std::int32_t>{0, 1}));
}

TEST(SurfaceQuality, every_kind_of_defect_is_counted) {
    TriangleMesh closed{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},
                        {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};
    EXPECT_TRUE(measure(closed).closed_and_oriented());
    EXPECT_NEAR(measure(closed).volume, 1.0 / 6, rounding);

    TriangleMesh open = closed;
    open.triangles.pop_back();
    EXPECT_EQ(measure(open).open_edges, 3);

    TriangleMesh turned = closed;
    std::swap(turned.triangles[0][0], turned.triangles[0][1]);
    EXPECT_EQ(measure(turned).misoriented_edges, 3);

    TriangleMesh inside_out = closed;
    for (Triangle& t : inside_out.triangles) std::swap(t[0], t[1]);
    EXPECT_FALSE(measure(inside_out).closed_and_oriented());

    TriangleMesh finned = closed;
    finned.vertices.emplace_back(5, 5, 5);
    finned.triangles.push_back({0, 1, 4});
    EXPECT_EQ(measure(finned).non_manifold_edges, 1);

    TriangleMesh degenerate = closed;
    degenerate.triangles.push_back({0, 0, 1});
    EXPECT_EQ(measure(degenerate).degenerate_triangles, 1);

    TriangleMesh twins = closed;
    for (const Eigen::Vector3d& p : closed.vertices) twins.vertices.push_back(p + Eigen::Vector3d(9, 9, 9));
    for (const Triangle& t : closed.triangles) twins.triangles.push_back({t[0] + 4, t[1] + 4, t[2] + 4});
    EXPECT_EQ(measure(twins).components, 2);
}

TEST(Fidelity, box_of_tetrahedra_paints_exactly_its_voxels) {
    // Voxel centres at half integers lie inside one cube each.
    ImageGrid grid;
    grid.size = {7, 6, 5};
    grid.origin = {-0.5, -0.5, -0.5};
    const TetMesh mesh = box(4, 3, 2);
    const std::vector<std::int32_t> painted = voxelise(mesh, grid);
    for (std::int32_t k = 0; k < 5; ++k)
        for (std::int32_t j = 0; j < 6; ++j)
            for (std::int32_t i = 0; i < 7; ++i) {
                const bool inside = i >= 1 && i <= 4 && j >= 1 && j <= 3 && k >= 1 && k <= 2;
                EXPECT_EQ(painted[grid.offset(i, j, k)], !inside ? 0 : i <= 2 ? 4 : 9);
            }
}

TEST(Fidelity, comparison_of_a_shifted_label_is_a_hand_calculation) {
    // The label of region 4 is a voxel longer than its 2 x 3 x 2 box: 12 against 18 voxels, 12 in common.
    ImageGrid grid;
    grid.size = {7, 6, 5};
    grid.origin = {-1.5, -0.5, -0.5};
    LabelMap map{grid, std::vector<std::uint16_t>(grid.voxel_count(), 0), {{4, "a"}, {9, "b"}}};
    for (std::int32_t k = 1; k <= 2; ++k)
        for (std::int32_t j = 1; j <= 3; ++j)
            for (std::int32_t i = 1; i <= 5; ++i) map.labels[grid.offset(i, j, k)] = i <= 3 ? 4 : 9;
    const std::array<std::int32_t, 2> both{4, 9};
    const BodyFidelity result = compare(box(4, 3, 2), cut_out_regions(map, both, 1));
    const std::vector<RegionFidelity>& fidelity = result.regions;
    ASSERT_EQ(fidelity.size(), 2U);
    EXPECT_NEAR(result.body.dice, 2 * 24.0 / (24 + 30), rounding);
    EXPECT_NEAR(result.body.centroid_distance, 0.5, rounding);
    EXPECT_NEAR(fidelity[0].volume_error_percent, 100 * (12.0 / 18 - 1), 1e-9);
    EXPECT_NEAR(fidelity[0].dice, 2 * 12.0 / (12 + 18), rounding);
    EXPECT_NEAR(fidelity[0].centroid_distance, 0.5, rounding);
    EXPECT_NEAR(fidelity[1].dice, 1, rounding);
    EXPECT_NEAR(fidelity[1].centroid_distance, 0, rounding);
}

TEST(Fidelity, map_without_the_region_is_refused) {
    ImageGrid grid;
    grid.size = {3, 3, 3};
    const LabelMap map{grid, std::vector<std::uint16_t>(27, 4), {{4, "a"}}};
    const std::array<std::int32_t, 1> one{4};
    EXPECT_THROW(compare(box(4, 3, 2), cut_out_regions(map, one, 1)), InvalidInput);
}

}  // namespace
}  // namespace palpate
