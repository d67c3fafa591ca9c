// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/tool_shadow.hpp"

#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkProperty.h>

#include "runtime/visual/actors.hpp"

namespace palpate::visual {
namespace {

constexpr vtkIdType ring_points = DropMark::ring_points, foot = ring_points, tool_centre = ring_points + 1;
const Rgb shade_colour(10, 10, 14), rim_colour(250, 250, 250);

// Unlit: a sign, not a thing.
vtkSmartPointer<vtkActor> flat_actor(vtkPolyData* data, const Rgb& colour, vtkRenderer* renderer) {
    auto result = actor(data, colour);
    result->GetProperty()->LightingOff();
    result->VisibilityOff();
    renderer->AddActor(result);
    return result;
}

}  // namespace

ToolShadow::ToolShadow(vtkRenderer* renderer) : points_(vtkSmartPointer<vtkPoints>::New()) {
    points_->SetNumberOfPoints(ring_points + 2);
    vtkNew<vtkCellArray> fan, lines;
    for (vtkIdType i = 0; i < ring_points; ++i) fan->InsertNextCell({foot, i, (i + 1) % ring_points});
    lines->InsertNextCell(ring_points + 1);
    for (vtkIdType i = 0; i <= ring_points; ++i) lines->InsertCellPoint(i % ring_points);
    lines->InsertNextCell({foot, tool_centre});
    vtkNew<vtkPolyData> shade, rim;
    shade->SetPoints(points_);
    shade->SetPolys(fan);
    rim->SetPoints(points_);
    rim->SetLines(lines);
    shade_ = flat_actor(shade, shade_colour, renderer);
    shade_->GetProperty()->SetOpacity(0.4);
    lines_ = flat_actor(rim, rim_colour, renderer);
    lines_->GetProperty()->SetLineWidth(2);
}

void ToolShadow::update(const Eigen::Vector3d& tool, const std::optional<DropMark>& mark) {
    shade_->SetVisibility(mark.has_value());
    lines_->SetVisibility(mark.has_value());
    if (!mark) return;
    for (vtkIdType i = 0; i < ring_points; ++i)
        points_->SetPoint(i, mark->ring[static_cast<std::size_t>(i)].data());
    points_->SetPoint(foot, mark->foot.data());
    points_->SetPoint(tool_centre, tool.data());
    points_->Modified();
}

}  // namespace palpate::visual
