// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/tools/meshing/phantom.hpp"
#include "tools/meshing/measures/quality.hpp"
#include "tools/meshing/measures/tet_faces.hpp"
#include "tools/meshing/surfaces/surfaces.hpp"
#include "tools/meshing/tetrahedra/move_nodes.hpp"
#include "tools/meshing/tetrahedra/surface_fit.hpp"
#include "tools/meshing/tetrahedra/tetrahedralise.hpp"

namespace palpate {
namespace {

using namespace meshing;

// An organ's mesh with its regions numbered 1 and 2, and the labels it was made from.
struct NumberedBody {
    MeshDomain domain;
    TetMesh mesh;
};

NumberedBody organ() {
    const LabelMap map = test::organ_with_lesion();
    NumberedBody body{prepare_domain(map, test::organ_and_lesion, 1.4, 40), {}};
    body.mesh = tetrahedralise(body.domain, map, {.cell_size = 5});
    for (std::int32_t& region : body.mesh.regions) region = region == 3 ? 1 : 2;
    return body;
}

// The mean distance of the lesion's triangles' centres from the sphere that was painted.
double mean_distance_from_lesion(const TetMesh& mesh) {
    double sum = 0, area = 0;
    for (const InterfaceFace& face : interface_faces(mesh)) {
        if (face.inner != 2 && face.outer != 2) continue;
        std::array<Eigen::Vector3d, 3> p;
        for (std::size_t c = 0; c < 3; ++c)
            p[c] = mesh.rest_positions[static_cast<std::size_t>(face.nodes[c])] - test::lesion_center;
        const double weight = (p[1] - p[0]).cross(p[2] - p[0]).norm();
        sum += weight * std::abs(((p[0] + p[1] + p[2]) / 3).norm() - 6.5);
        area += weight;
    }
    return sum / area;
}

// Two cubes, 1 mm apart along x at x = 10 mm.
TetMesh neighbours() {
    TetMesh mesh = sample::cube_mesh(2, 10);
    const TetMesh other = mesh;
    const auto shift = static_cast<std::int32_t>(other.rest_positions.size());
    for (const Eigen::Vector3d& p : other.rest_positions)
        mesh.rest_positions.push_back(p + Eigen::Vector3d(11, 0, 0));
    for (const auto& [a, b, c, d] : other.tetrahedra)
        mesh.tetrahedra.push_back({a + shift, b + shift, c + shift, d + shift});
    return mesh;
}

TEST(MoveNodes, neighbours_are_not_pushed_through_each_other) {
    TetMesh mesh = neighbours();
    const std::vector<Eigen::Vector3d> before = mesh.rest_positions;
    Eigen::VectorXd step = Eigen::VectorXd::Zero(3 * static_cast<Eigen::Index>(before.size()));
    for (std::size_t node = 0; node < before.size(); ++node)
        if (const double x = before[node].x(); x == 10 || x == 11)
            step[3 * static_cast<Eigen::Index>(node)] = x == 10 ? 1.5 : -0.75;
    TetMesh pushed = mesh;
    for (std::size_t node = 0; node < before.size(); ++node)
        pushed.rest_positions[node] += step.segment<3>(3 * static_cast<Eigen::Index>(node));
    ASSERT_FALSE(self_intersections(boundary_surface(pushed).surface).empty());
    move_nodes(mesh, step, 5);
    EXPECT_TRUE(self_intersections(boundary_surface(mesh).surface).empty());
    for (std::size_t node = 0; node < before.size(); ++node) {
        const double x = before[node].x(), quarter_step = x == 10 ? 0.375 : x == 11 ? -0.1875 : 0;
        EXPECT_NEAR(mesh.rest_positions[node].x() - x, quarter_step, 1e-12);
    }
}

TEST(FitSurface, triangles_that_were_pushed_off_come_back) {
    NumberedBody body = organ();
    const double fitted = mean_distance_from_lesion(body.mesh);
    std::vector<bool> on_lesion(body.mesh.rest_positions.size(), false);
    for (const InterfaceFace& face : interface_faces(body.mesh))
        for (const std::int32_t node : face.nodes)
            if (face.outer != 0) on_lesion[static_cast<std::size_t>(node)] = true;
    for (std::size_t node = 0; node < on_lesion.size(); ++node)
        if (on_lesion[node])
            body.mesh.rest_positions[node] +=
                0.7 * (body.mesh.rest_positions[node] - test::lesion_center).normalized();
    const double pushed = mean_distance_from_lesion(body.mesh);
    ASSERT_GT(pushed, 1.5 * fitted);
    fit_surface(body.mesh, body.domain.smoothed, 5, 1);
    EXPECT_LT(mean_distance_from_lesion(body.mesh), fitted + 0.25 * (pushed - fitted));
    EXPECT_EQ(measure(body.mesh).inverted, 0);
}

TEST(FitSurface, no_tetrahedron_gets_flatter_than_the_floor) {
    NumberedBody body = organ();
    constexpr double floor_deg = 14;
    ASSERT_GE(measure(body.mesh).min_dihedral_deg, floor_deg);
    for (Eigen::Vector3d& p : body.mesh.rest_positions) p *= 1.01;  // 1 % larger than its labels
    fit_surface(body.mesh, body.domain.smoothed, floor_deg, 1);
    const MeshQuality quality = measure(body.mesh);
    EXPECT_GE(quality.min_dihedral_deg, floor_deg);
    EXPECT_LE(quality.max_dihedral_deg, 180 - floor_deg);
}

TEST(MatchVolumes, targets_are_met_by_moving_interfaces_alone) {
    TetMesh mesh = organ().mesh;
    const TetMesh before = mesh;
    std::vector<double> targets;
    for (const RegionVolume& region : measure(mesh).region_volumes) targets.push_back(region.volume);
    targets[0] *= 1.01;
    targets[1] *= 0.97;
    match_volumes(mesh, targets, 10, 0.5);
    const auto after = measure(mesh).region_volumes;
    for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(after[k].volume / targets[k], 1, 1e-4);
    for (std::size_t node = 0; node < mesh.rest_positions.size(); ++node)
        EXPECT_LT((mesh.rest_positions[node] - before.rest_positions[node]).norm(), 0.5);
}

TEST(MatchVolumes, region_without_a_target_is_refused) {
    TetMesh mesh = organ().mesh;
    const std::vector<double> one{1.0};
    EXPECT_THROW(match_volumes(mesh, one, 10, 1), InvalidInput);
}

}  // namespace
}  // namespace palpate
