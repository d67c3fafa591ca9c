// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <numeric>
#include <random>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkMeshQuality.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkUnstructuredGrid.h>

#include "tests/formats/sample_case.hpp"
#include "tools/meshing/measures/quality.hpp"
#include "tools/report/quality.hpp"

namespace palpate {
namespace {

using namespace meshing;
using namespace report;

constexpr double round_off = 1e-9;

TetMesh one_tet(const std::array<Eigen::Vector3d, 4>& corners) {
    TetMesh mesh;
    mesh.rest_positions.assign(corners.begin(), corners.end());
    mesh.tetrahedra = {{0, 1, 2, 3}};
    mesh.regions = {1};
    mesh.region_names = {{.value = 1, .name = "tissue"}};
    return mesh;
}

TetMesh shaken_cube() {
    TetMesh mesh = sample::cube_mesh(4, 20);
    std::mt19937 random(7);
    std::uniform_real_distribution<double> shift(-0.6, 0.6);
    for (Eigen::Vector3d& p : mesh.rest_positions)
        p += Eigen::Vector3d(shift(random), shift(random), shift(random));
    return mesh;
}

// VTK's verdict library, one value per tetrahedron.
std::vector<double> vtk_measure(const TetMesh& mesh, int measure) {
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    for (const Eigen::Vector3d& p : mesh.rest_positions) points->InsertNextPoint(p.data());
    vtkNew<vtkUnstructuredGrid> grid;
    grid->SetPoints(points);
    for (const Tetrahedron& tet : mesh.tetrahedra) {
        const std::array<vtkIdType, 4> corners{tet[0], tet[1], tet[2], tet[3]};
        grid->InsertNextCell(VTK_TETRA, 4, corners.data());
    }
    vtkNew<vtkMeshQuality> quality;
    quality->SetInputData(grid);
    quality->SetTetQualityMeasure(measure);
    quality->Update();
    vtkDataArray* values = quality->GetOutput()->GetCellData()->GetArray("Quality");
    std::vector<double> result;
    for (vtkIdType i = 0; i < values->GetNumberOfTuples(); ++i) result.push_back(values->GetTuple1(i));
    return result;
}

TEST(TetShape, regular_tetrahedron_has_arccos_of_a_third_and_ratio_one) {
    const TetShape shape = tet_shape(one_tet({{{1, 1, 1}, {-1, 1, -1}, {1, -1, -1}, {-1, -1, 1}}}), 0);
    for (const double angle : shape.dihedral_deg) EXPECT_NEAR(angle, 70.528779365509308, round_off);
    EXPECT_NEAR(shape.radius_ratio, 1, round_off);
}

TEST(TetShape, corner_of_a_cube_has_three_right_angles) {
    TetShape shape = tet_shape(one_tet({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}}), 0);
    std::ranges::sort(shape.dihedral_deg);
    for (std::size_t i = 0; i < 3; ++i) {
        EXPECT_NEAR(shape.dihedral_deg[i], 54.735610317245346, round_off);  // arctan(sqrt 2)
        EXPECT_NEAR(shape.dihedral_deg[i + 3], 90, round_off);
    }
}

// The angle at each edge between the two other corners, seen along the edge.
std::array<double, 6> angles_seen_along_edges(const TetMesh& mesh, const Tetrahedron& tet) {
    const auto p = [&](std::size_t i) { return mesh.rest_positions[static_cast<std::size_t>(tet[i])]; };
    std::array<double, 6> angles{};
    std::size_t edge = 0;
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = i + 1; j < 4; ++j) {
            const Eigen::Vector3d axis = (p(j) - p(i)).normalized();
            std::vector<Eigen::Vector3d> across;
            for (std::size_t k = 0; k < 4; ++k)
                if (k != i && k != j) across.push_back((p(k) - p(i)) - axis * axis.dot(p(k) - p(i)));
            const double cosine = across[0].normalized().dot(across[1].normalized());
            angles[edge++] = std::acos(cosine) * 180 / std::numbers::pi;
        }
    return angles;
}

TEST(TetShape, dihedral_angles_are_those_seen_along_the_edges) {
    const TetMesh mesh = shaken_cube();
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        auto angles = tet_shape(mesh, t).dihedral_deg;
        auto expected = angles_seen_along_edges(mesh, mesh.tetrahedra[t]);
        std::ranges::sort(angles);
        std::ranges::sort(expected);
        for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(angles[i], expected[i], round_off);
    }
}

TEST(TetShape, radius_ratio_is_the_inverse_of_verdicts) {
    const TetMesh mesh = shaken_cube();
    const auto ratios = vtk_measure(mesh, VTK_QUALITY_RADIUS_RATIO);
    ASSERT_EQ(ratios.size(), mesh.tetrahedra.size());
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        EXPECT_NEAR(tet_shape(mesh, t).radius_ratio * ratios[t], 1, round_off);
}

TEST(MeshSummary, counts_every_angle_and_every_millilitre) {
    const TetMesh mesh = sample::cube_mesh(4, 20);
    const MeshSummary summary = summarise(mesh);
    const auto sum = [](const BinCounts& h) {
        return std::accumulate(h.counts.begin(), h.counts.end(), std::int64_t{0});
    };
    const auto tetrahedra = static_cast<std::int64_t>(mesh.tetrahedra.size());
    EXPECT_EQ(sum(summary.dihedral_deg), 6 * tetrahedra);
    EXPECT_EQ(sum(summary.radius_ratio), tetrahedra);
    ASSERT_EQ(summary.region_volumes.size(), 2U);
    EXPECT_NEAR(summary.region_volumes[0] + summary.region_volumes[1], 20.0 * 20 * 20, 1e-6);
    EXPECT_NEAR(summary.min_volume, 125.0 / 6, 1e-9);
    // Kuhn's tetrahedra have dihedral angles of 45, 60 and 90 degrees.
    EXPECT_NEAR(summary.min_dihedral_deg, 45, round_off);
    EXPECT_NEAR(summary.max_dihedral_deg, 90, round_off);
    EXPECT_NEAR(summary.min_radius_ratio, summary.mean_radius_ratio, 1e-6);
}

}  // namespace
}  // namespace palpate
