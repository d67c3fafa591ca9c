// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/labels/voxelised.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkImageData.h>
#include <vtkImageStencilToImage.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataToImageStencil.h>

#include "formats/model/errors.hpp"

namespace palpate::meshing {
namespace {

vtkNew<vtkPolyData> polygons_of(const TriangleMesh& surface) {
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    for (const Eigen::Vector3d& p : surface.vertices) points->InsertNextPoint(p.data());
    vtkNew<vtkCellArray> cells;
    for (const Triangle& t : surface.triangles) {
        const std::array<vtkIdType, 3> corners{t[0], t[1], t[2]};
        cells->InsertNextCell(3, corners.data());
    }
    vtkNew<vtkPolyData> data;
    data->SetPoints(points);
    data->SetPolys(cells);
    return data;
}

}  // namespace

LabelMap voxelised(const TriangleMesh& surface, const std::string& name, double spacing) {
    constexpr int margin = 3;  // voxels
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& p : surface.vertices) box.extend(p);
    LabelMap map;
    map.names.push_back({1, name});
    map.grid.spacing.setConstant(spacing);
    map.grid.origin = box.min().array() - margin * spacing;
    for (std::size_t axis = 0; axis < 3; ++axis)
        map.grid.size[axis] =
            static_cast<std::int32_t>(std::ceil(box.sizes()[static_cast<Eigen::Index>(axis)] / spacing)) +
            2 * margin + 1;
    const auto& [ni, nj, nk] = map.grid.size;

    const vtkNew<vtkPolyData> polygons = polygons_of(surface);
    vtkNew<vtkPolyDataToImageStencil> stencil;
    stencil->SetInputData(polygons);
    stencil->SetOutputOrigin(map.grid.origin.data());
    stencil->SetOutputSpacing(spacing, spacing, spacing);
    stencil->SetOutputWholeExtent(0, ni - 1, 0, nj - 1, 0, nk - 1);
    vtkNew<vtkImageStencilToImage> image;
    image->SetInputConnection(stencil->GetOutputPort());
    image->SetInsideValue(1);
    image->SetOutsideValue(0);
    image->SetOutputScalarTypeToUnsignedChar();
    image->Update();
    const auto* voxels = static_cast<const unsigned char*>(image->GetOutput()->GetScalarPointer(0, 0, 0));
    map.labels.assign(voxels, voxels + map.grid.voxel_count());
    if (std::ranges::find(map.labels, 1) == map.labels.end())
        throw InvalidInput({"'" + name + "'", fmt::format("encloses no voxel of {:g} mm", spacing), "",
                            "is the surface closed, and its unit right?"});
    return map;
}

}  // namespace palpate::meshing
