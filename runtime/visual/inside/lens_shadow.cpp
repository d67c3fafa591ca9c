// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/inside/lens_shadow.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vtkCellArray.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper2D.h>
#include <vtkUnsignedCharArray.h>

namespace palpate::visual {
namespace {

constexpr vtkIdType corners = 72;    // of a circle
constexpr double soft_share = 0.08;  // of the circle's radius: over which it goes black

}  // namespace

LensShadow::LensShadow(vtkRenderer* renderer) : renderer_(renderer) {
    constexpr std::array<unsigned char, 3> opacities{0, 255, 255};
    points_->SetNumberOfPoints(3 * corners);
    vtkNew<vtkUnsignedCharArray> colours;
    colours->SetNumberOfComponents(4);
    for (const unsigned char opacity : opacities)
        for (vtkIdType i = 0; i < corners; ++i) {
            const std::array<unsigned char, 4> black{0, 0, 0, opacity};
            colours->InsertNextTypedTuple(black.data());
        }
    vtkNew<vtkCellArray> quads;
    for (const vtkIdType ring : {vtkIdType{0}, corners})
        for (vtkIdType i = 0; i < corners; ++i) {
            const vtkIdType next = (i + 1) % corners;
            quads->InsertNextCell({ring + i, ring + next, ring + corners + next, ring + corners + i});
        }
    vtkNew<vtkPolyData> data;
    data->SetPoints(points_);
    data->SetPolys(quads);
    data->GetPointData()->SetScalars(colours);
    vtkNew<vtkPolyDataMapper2D> mapper;
    mapper->SetInputData(data);
    actor_->SetMapper(mapper);
    actor_->VisibilityOff();
    renderer->AddActor2D(actor_);
}

void LensShadow::fit() {
    const int* now = renderer_->GetSize();
    const std::array<int, 2> size{now[0], now[1]};
    if (size == size_) return;
    size_ = size;
    const double x = 0.5 * size[0], y = 0.5 * size[1], radius = std::min(x, y);
    vtkIdType point = 0;
    for (const double ring : {(1 - soft_share) * radius, radius, 1.1 * std::hypot(x, y)})
        for (vtkIdType i = 0; i < corners; ++i) {
            const double angle = 2 * std::numbers::pi * static_cast<double>(i) / corners;
            points_->SetPoint(point++, x + ring * std::cos(angle), y + ring * std::sin(angle), 0);
        }
    points_->Modified();
}

}  // namespace palpate::visual
