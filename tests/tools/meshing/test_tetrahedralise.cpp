// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "tests/tools/meshing/phantom.hpp"
#include "tests/tools/refusal_of.hpp"
#include "tools/meshing/contract/fidelity.hpp"
#include "tools/meshing/measures/quality.hpp"
#include "tools/meshing/tetrahedra/tetrahedralise.hpp"

namespace palpate {
namespace {

using namespace meshing;
using test::organ_center;
using test::organ_with_lesion;

const MeshSizing coarse{.cell_size = 3.5};

// The labels are the reference: a mesh must keep volume (matched to 1e-4), place and shape.
constexpr double max_volume_error_percent = 0.05;
constexpr double max_centroid_distance = 0.05;  // mm
constexpr double min_dice = 0.97;  // the lesion is 13 voxels across: its outermost layer is a third of it

void expect_faithful(const TetMesh& mesh, const LabelMap& map) {
    const MeshQuality quality = measure(mesh);
    EXPECT_EQ(quality.inverted, 0);
    EXPECT_EQ(quality.components, 1);
    EXPECT_TRUE(quality.boundary.closed_and_oriented());
    EXPECT_GE(quality.min_dihedral_deg, 12);
    EXPECT_LE(quality.max_dihedral_deg, 165);
    const auto fidelity = compare(mesh, cut_out_regions(map, test::organ_and_lesion, 1)).regions;
    ASSERT_EQ(fidelity.size(), 2U);
    for (const RegionFidelity& region : fidelity) {
        EXPECT_LT(std::abs(region.volume_error_percent), max_volume_error_percent) << region.region;
        EXPECT_LT(region.centroid_distance, max_centroid_distance) << region.region;
        EXPECT_GT(region.dice, min_dice) << region.region;
    }
}

TEST(Tetrahedralise, enclosed_lesion_keeps_volume_place_and_shape) {
    const LabelMap map = organ_with_lesion();
    expect_faithful(tetrahedralise(map, test::organ_and_lesion, coarse), map);
}

TEST(Tetrahedralise, any_direction_matrix_gives_the_same_body) {
    Eigen::Matrix3d oblique =
        Eigen::AngleAxisd(0.35, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    Eigen::Matrix3d flipped = Eigen::Vector3d(-1, -1, 1).asDiagonal();
    Eigen::Matrix3d left_handed = Eigen::Vector3d(1, 1, -1).asDiagonal();
    Eigen::Matrix3d permuted;
    permuted << 0, 0, 1, 1, 0, 0, 0, 1, 0;
    for (const Eigen::Matrix3d& direction : {oblique, flipped, left_handed, permuted}) {
        const LabelMap map = organ_with_lesion(direction);
        expect_faithful(tetrahedralise(map, test::organ_and_lesion, coarse), map);
    }
}

TEST(Tetrahedralise, two_runs_give_the_same_bytes) {
    const LabelMap map = organ_with_lesion();
    const TetMesh a = tetrahedralise(map, test::organ_and_lesion, coarse);
    const TetMesh b = tetrahedralise(map, test::organ_and_lesion, coarse);
    EXPECT_EQ(a.rest_positions, b.rest_positions);
    EXPECT_EQ(a.tetrahedra, b.tetrahedra);
    EXPECT_EQ(a.regions, b.regions);
    EXPECT_EQ(a.outside_labels, b.outside_labels);
}

TEST(Tetrahedralise, surface_nodes_know_what_lies_beyond) {
    const LabelMap map = organ_with_lesion();
    const TetMesh mesh = tetrahedralise(map, test::organ_and_lesion, coarse);
    ASSERT_EQ(mesh.outside_labels.size(), mesh.rest_positions.size());
    const BoundarySurface boundary = boundary_surface(mesh);
    std::int64_t bone = 0;
    for (std::size_t node = 0; node < mesh.rest_positions.size(); ++node) {
        const std::int32_t label = mesh.outside_labels[node];
        if (!std::ranges::binary_search(boundary.nodes, static_cast<std::int32_t>(node))) {
            EXPECT_EQ(label, -1);
            continue;
        }
        // The organ is cut off by bone at x = 15 mm; near the rim of the cut either answer is right.
        const Eigen::Vector3d p = mesh.rest_positions[node] - organ_center;
        const double radius = p.tail<2>().norm(), rim = std::sqrt(20.0 * 20 - 15 * 15);
        if (p.x() < 12) {
            EXPECT_EQ(label, 0) << p.transpose();
        }
        if (p.x() > 14 && radius < rim - 2) {
            EXPECT_EQ(label, 12) << p.transpose();
        }
        bone += label == 12;
    }
    EXPECT_GT(bone, 10);
    ASSERT_EQ(mesh.outside_names.size(), 1U);
    EXPECT_EQ(mesh.outside_names[0].name, "bone");
    ASSERT_EQ(mesh.region_names.size(), 2U);
    EXPECT_EQ(mesh.region_names[1].name, "lesion");
}

TEST(Tetrahedralise, region_size_refines_its_region_alone) {
    const LabelMap map = organ_with_lesion();
    MeshSizing fine = coarse;
    fine.regions = {{7, 1.5}};
    const auto lesion_cells = [](const TetMesh& mesh) { return std::ranges::count(mesh.regions, 7); };
    const TetMesh a = tetrahedralise(map, test::organ_and_lesion, coarse);
    const TetMesh b = tetrahedralise(map, test::organ_and_lesion, fine);
    EXPECT_GT(lesion_cells(b), 4 * lesion_cells(a));
    expect_faithful(b, map);
}

TEST(Tetrahedralise, body_at_the_border_of_the_image_is_closed_there) {
    // Fills its image but for one end.
    const LabelMap map =
        test::paint(test::grid_around(organ_center, Eigen::Matrix3d::Identity(), {30, 30, 20}),
                    [](const Eigen::Vector3d& p) { return p.z() < organ_center.z() ? 1 : 0; }, {{1, "slab"}});
    const std::array<std::int32_t, 1> slab{1};
    const TetMesh mesh = tetrahedralise(map, slab, coarse);
    EXPECT_TRUE(measure(mesh).boundary.closed_and_oriented());
    const auto fidelity = compare(mesh, cut_out_regions(map, slab, 1)).regions;
    EXPECT_LT(std::abs(fidelity[0].volume_error_percent), max_volume_error_percent);
    EXPECT_GT(fidelity[0].dice, 0.95);  // edges and corners of the slab are rounded
    EXPECT_EQ(std::ranges::max(mesh.outside_labels), 0);
}

LabelMap islands() {
    return test::paint(test::grid_around(organ_center, Eigen::Matrix3d::Identity(), {90, 50, 40}),
                       [](const Eigen::Vector3d& p) {
                           if ((p - organ_center + Eigen::Vector3d(20, 0, 0)).norm() < 15) return 5;
                           if ((p - organ_center - Eigen::Vector3d(20, 0, 0)).norm() < 4) return 5;
                           return 0;
                       },
                       {{5, "islands"}});
}

TEST(Tetrahedralise, every_component_arrives_at_any_cell_size) {
    // The smaller island, 4 mm in radius, is smaller than one cell of 12 mm.
    const std::array<std::int32_t, 1> both{5};
    for (const double cell_size : {3.0, 12.0})
        EXPECT_EQ(measure(tetrahedralise(islands(), both, {.cell_size = cell_size})).components, 2)
            << cell_size;
}

TEST(Tetrahedralise, specks_and_pinholes_below_the_stated_volume_vanish) {
    LabelMap map = islands();
    const auto center = map.grid.index_of(organ_center - Eigen::Vector3d(20, 0, 0));
    map.labels[map.grid.offset(static_cast<std::int32_t>(center.x()), static_cast<std::int32_t>(center.y()),
                               static_cast<std::int32_t>(center.z()))] = 0;
    map.labels[map.grid.offset(45, 5, 5)] = 5;
    const std::array<std::int32_t, 1> label{5};
    const TetMesh mesh = tetrahedralise(map, label, {.cell_size = 5, .min_component_volume = 500});
    const MeshQuality quality = measure(mesh);
    EXPECT_EQ(quality.components, 1);           // the small island has 268 mm³
    EXPECT_EQ(quality.boundary.components, 1);  // a pinhole would have a surface of its own
}

TEST(Tetrahedralise, cells_near_a_place_or_a_label_are_finer) {
    const LabelMap map = organ_with_lesion();
    const auto cells_within = [](const TetMesh& mesh, const Eigen::Vector3d& place, double reach) {
        return std::ranges::count_if(mesh.tetrahedra, [&](const Tetrahedron& tet) {
            Eigen::Vector3d center = Eigen::Vector3d::Zero();
            for (const std::int32_t node : tet)
                center += mesh.rest_positions[static_cast<std::size_t>(node)] / 4;
            return (center - place).norm() < reach;
        });
    };
    const Eigen::Vector3d place = organ_center - Eigen::Vector3d(19, 0, 0);
    MeshSizing at_point = coarse, at_label = coarse;
    at_point.near = {{.points = {place}, .label = 0, .within = 6, .cell_size = 1.5}};
    at_label.near = {{.points = {}, .label = 12, .within = 3, .cell_size = 1.5}};  // bone, a neighbour
    const TetMesh plain = tetrahedralise(map, test::organ_and_lesion, coarse);
    const TetMesh fine = tetrahedralise(map, test::organ_and_lesion, at_point);
    EXPECT_GT(cells_within(fine, place, 6), 4 * cells_within(plain, place, 6));
    const Eigen::Vector3d far = organ_center + Eigen::Vector3d(0, 14, 8);
    EXPECT_LT(cells_within(fine, far, 6), 1.5 * static_cast<double>(cells_within(plain, far, 6)));
    const Eigen::Vector3d by_bone = organ_center + Eigen::Vector3d(14, 0, 0);
    const TetMesh by_label = tetrahedralise(map, test::organ_and_lesion, at_label);
    EXPECT_GT(cells_within(by_label, by_bone, 4), 4 * cells_within(plain, by_bone, 4));
    expect_faithful(fine, map);
}

TEST(Tetrahedralise, component_just_above_the_speck_limit_is_there) {
    const LabelMap map = test::paint(
        test::grid_around(organ_center, Eigen::Matrix3d::Identity(), {30, 30, 30}),
        [](const Eigen::Vector3d& p) { return (p - organ_center).norm() < 2.2 ? 1 : 0; }, {{1, "speck"}});
    const double volume = static_cast<double>(std::ranges::count(map.labels, 1)) * map.grid.voxel_volume();
    const std::array<std::int32_t, 1> one{1};
    const TetMesh mesh = tetrahedralise(map, one, {.cell_size = 4, .min_component_volume = 0.98 * volume});
    EXPECT_NEAR(measure(mesh).region_volumes.at(0).volume, volume, 0.05 * volume);
}

TEST(Tetrahedralise, cell_larger_than_the_body_is_as_good_as_one_of_its_size) {
    const LabelMap map = organ_with_lesion();
    const auto count = [&](double cell_size) {
        return tetrahedralise(map, test::organ_and_lesion, {.cell_size = cell_size}).tetrahedra.size();
    };
    const std::size_t largest = count(1000);
    for (const double cell_size : {1000.0, 100.0, 1000.0, 50.0}) EXPECT_EQ(count(cell_size), largest);
}

TEST(Tetrahedralise, unsmoothed_labels_are_meshed) {
    const LabelMap map = organ_with_lesion();
    const TetMesh mesh = tetrahedralise(map, test::organ_and_lesion, {.cell_size = 4, .smoothing = 0});
    EXPECT_TRUE(measure(mesh).boundary.closed_and_oriented());
    EXPECT_LT(
        std::abs(compare(mesh, cut_out_regions(map, test::organ_and_lesion, 1)).body.volume_error_percent),
        max_volume_error_percent);
}

TEST(Tetrahedralise, impossible_requests_are_refused) {
    const LabelMap map = islands();
    const std::array<std::int32_t, 1> label{5}, absent{6};
    const std::array<std::int32_t, 2> twice{5, 5};
    EXPECT_THROW(tetrahedralise(map, absent, coarse), InvalidInput);
    EXPECT_THROW(tetrahedralise(map, twice, coarse), InvalidInput);
    EXPECT_THROW(tetrahedralise(map, {}, coarse), InvalidInput);
    EXPECT_THROW(tetrahedralise(map, label, {.cell_size = 0}), InvalidInput);
    EXPECT_THROW(tetrahedralise(map, label, {.cell_size = 0.05}), InvalidInput);  // hundreds of millions
    EXPECT_THROW(tetrahedralise(map, label, {.smoothing = 100}), InvalidInput);
    EXPECT_THROW(tetrahedralise(map, label, {.smoothing = std::nan("")}), InvalidInput);
    EXPECT_THROW(tetrahedralise(map, label, {.facet_size = -1}), InvalidInput);
    EXPECT_THROW(tetrahedralise(map, label, {.facet_distance = -1}), InvalidInput);
    EXPECT_THROW(tetrahedralise(map, label, {.facet_angle_deg = 31}), InvalidInput);
    EXPECT_THROW(tetrahedralise(map, label, {.cell_radius_edge = 1.9}), InvalidInput);
    EXPECT_THROW(tetrahedralise(map, label, {.regions = {{5, -2}}}), InvalidInput);
    EXPECT_THROW(tetrahedralise(map, label, {.regions = {{5, 2, 0}}}), InvalidInput);
    EXPECT_THROW(tetrahedralise(map, label, {.near = {{{{0, 0, 0}}, 0, 0, 1}}}), InvalidInput);
    EXPECT_THROW(tetrahedralise(map, label, {.near = {{{{0, 0, 0}}, 0, 1, 0}}}), InvalidInput);
}

TEST(Tetrahedralise, what_would_never_end_is_refused_by_what_makes_it_so) {
    const LabelMap map = islands();
    const std::array<std::int32_t, 1> label{5};
    const auto voxel = static_cast<std::int32_t>(std::ranges::find(map.labels, 5) - map.labels.begin());
    const std::int32_t columns = map.grid.size[0], rows = map.grid.size[1];
    const Eigen::Vector3d inside = map.grid.point_of(
        Eigen::Vector3i(voxel % columns, voxel / columns % rows, voxel / columns / rows).cast<double>());
    const auto refusal = [&](const MeshSizing& sizing) {
        return test::refusal_of([&] { tetrahedralise(map, label, sizing); });
    };
    const auto expect = [](const std::string& said, const std::string& phrase) {
        EXPECT_NE(said.find(phrase), std::string::npos) << said;
    };
    const std::string thousandth = "a thousandth of a voxel's edge";
    expect(refusal({.facet_distance = 1e-9}), thousandth);
    expect(refusal({.facet_size = 1e-9}), thousandth);
    expect(refusal({.near = {{{inside}, 0, 1e9, 1e-9}}}), thousandth);
    expect(refusal({.regions = {{5, 1e-9}}}), thousandth);
    const double fine = 0.002 * map.grid.spacing.minCoeff();
    expect(refusal({.facet_size = fine}), "facet size: ");
    expect(refusal({.near = {{{inside}, 0, 1e9, fine}}}), "cell size near a place: ");
    expect(refusal({.near = {{{inside}, 0, 200 * fine, fine}}}), "cell size near a place: ");
    expect(refusal({.regions = {{5, fine}}}), "cell size: ");
    // Far from the body nothing becomes finer, however large the ball is.
    const Eigen::Vector3d away = inside + Eigen::Vector3d(1e4, 0, 0);
    EXPECT_GT(
        tetrahedralise(map, label, {.cell_size = 20, .near = {{{away}, 0, 5e3, fine}}}).tetrahedra.size(),
        0U);
}

}  // namespace
}  // namespace palpate
