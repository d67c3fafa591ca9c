// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/quads.hpp"

#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkProperty2D.h>

namespace palpate::visual {

void make_quads(vtkActor2D* actor, vtkPoints* points, const Rgb& colour, double opacity,
                vtkRenderer* renderer) {
    vtkNew<vtkPolyData> data;
    data->SetPoints(points);
    vtkNew<vtkPolyDataMapper2D> mapper;
    mapper->SetInputData(data);
    actor->SetMapper(mapper);
    set_colour(actor, colour);
    actor->GetProperty()->SetOpacity(opacity);
    actor->VisibilityOff();
    set_quad_count(actor, points, 1);
    renderer->AddActor2D(actor);
}

void set_colour(vtkActor2D* actor, const Rgb& colour) {
    actor->GetProperty()->SetColor(colour[0] / 255, colour[1] / 255, colour[2] / 255);
}

void set_quad_count(vtkActor2D* actor, vtkPoints* points, vtkIdType count) {
    points->SetNumberOfPoints(4 * count);
    vtkNew<vtkCellArray> cells;
    for (vtkIdType i = 0; i < count; ++i) cells->InsertNextCell({4 * i, 4 * i + 1, 4 * i + 2, 4 * i + 3});
    auto* mapper = vtkPolyDataMapper2D::SafeDownCast(actor->GetMapper());
    mapper->GetInput()->SetPolys(cells);
}

void set_quad(vtkPoints* points, vtkIdType quad, double left, double bottom, double right, double top) {
    points->SetPoint(4 * quad, left, bottom, 0);
    points->SetPoint(4 * quad + 1, right, bottom, 0);
    points->SetPoint(4 * quad + 2, right, top, 0);
    points->SetPoint(4 * quad + 3, left, top, 0);
    points->Modified();
}

}  // namespace palpate::visual
