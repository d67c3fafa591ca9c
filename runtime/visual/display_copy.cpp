// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/display_copy.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vtkBinnedDecimation.h>
#include <vtkNew.h>
#include <vtkPolyData.h>

#include "runtime/visual/vtk_mesh.hpp"

namespace palpate {
namespace {

double area_of(const TriangleMesh& surface) {
    double area = 0;
    for (const Triangle& t : surface.triangles) {
        const auto corner = [&](std::size_t i) { return surface.vertices[static_cast<std::size_t>(t[i])]; };
        area += (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm() / 2;
    }
    return area;
}

}  // namespace

TriangleMesh display_copy(const TriangleMesh& surface, std::int64_t budget) {
    if (static_cast<std::int64_t>(surface.triangles.size()) <= budget) return surface;
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& p : surface.vertices) box.extend(p);
    // A surface of area A crosses about 1.5 A / h² cells of edge h, and each gives about two triangles.
    const double edge = std::sqrt(3 * area_of(surface) / static_cast<double>(budget));
    std::array<int, 3> divisions{};
    for (int axis = 0; axis < 3; ++axis)
        divisions[static_cast<std::size_t>(axis)] =
            std::max(1, static_cast<int>(std::ceil(box.sizes()[axis] / edge)));

    vtkNew<vtkBinnedDecimation> decimation;
    decimation->SetInputData(poly_data(surface));
    decimation->AutoAdjustNumberOfDivisionsOff();
    decimation->SetNumberOfDivisions(divisions.data());
    decimation->SetPointGenerationModeToBinAverages();
    decimation->Update();
    return triangle_mesh(decimation->GetOutput());
}

}  // namespace palpate
