// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/vtk_mesh.hpp"

#include <vtkCellArray.h>
#include <vtkCellArrayIterator.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>

namespace palpate {

vtkSmartPointer<vtkPolyData> poly_data(const TriangleMesh& surface) {
    vtkNew<vtkPoints> points;
    points->SetNumberOfPoints(static_cast<vtkIdType>(surface.vertices.size()));
    for (std::size_t i = 0; i < surface.vertices.size(); ++i)
        points->SetPoint(static_cast<vtkIdType>(i), surface.vertices[i].data());
    vtkNew<vtkCellArray> cells;
    cells->AllocateExact(static_cast<vtkIdType>(surface.triangles.size()),
                         3 * static_cast<vtkIdType>(surface.triangles.size()));
    for (const Triangle& t : surface.triangles) cells->InsertNextCell({t[0], t[1], t[2]});
    auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(points);
    data->SetPolys(cells);
    return data;
}

TriangleMesh triangle_mesh(vtkPolyData* data) {
    TriangleMesh mesh;
    mesh.vertices.resize(static_cast<std::size_t>(data->GetNumberOfPoints()));
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i)
        data->GetPoint(static_cast<vtkIdType>(i), mesh.vertices[i].data());
    const auto cells = vtk::TakeSmartPointer(data->GetPolys()->NewIterator());
    for (cells->GoToFirstCell(); !cells->IsDoneWithTraversal(); cells->GoToNextCell()) {
        vtkIdType size = 0;
        const vtkIdType* corners = nullptr;
        cells->GetCurrentCell(size, corners);
        if (size == 3)
            mesh.triangles.push_back({static_cast<std::int32_t>(corners[0]),
                                      static_cast<std::int32_t>(corners[1]),
                                      static_cast<std::int32_t>(corners[2])});
    }
    return mesh;
}

}  // namespace palpate
