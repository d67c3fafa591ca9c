// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/tools/tool_shapes.hpp"

#include <vtkArrowSource.h>
#include <vtkLineSource.h>
#include <vtkNew.h>
#include <vtkSphereSource.h>
#include <vtkTubeFilter.h>

namespace palpate::visual {

vtkSmartPointer<vtkActor> ball(double radius, const Rgb& colour, int resolution) {
    vtkNew<vtkSphereSource> sphere;
    sphere->SetRadius(radius);
    sphere->SetThetaResolution(resolution);
    sphere->SetPhiResolution(resolution);
    sphere->Update();
    return actor(sphere->GetOutput(), colour);
}

vtkSmartPointer<vtkActor> tool_shaft(double tip_radius, double length, const Rgb& colour) {
    vtkNew<vtkLineSource> axis;
    axis->SetPoint1(0, 0, 0);
    axis->SetPoint2(length, 0, 0);
    vtkNew<vtkTubeFilter> tube;
    tube->SetInputConnection(axis->GetOutputPort());
    tube->SetRadius(0.45 * tip_radius);
    tube->SetNumberOfSides(16);
    tube->CappingOn();
    tube->Update();
    return actor(tube->GetOutput(), colour);
}

vtkSmartPointer<vtkActor> force_arrow(double width, const Rgb& colour) {
    vtkNew<vtkArrowSource> arrow;
    arrow->SetShaftRadius(0.045 * width);
    arrow->SetTipRadius(0.11 * width);
    arrow->SetTipLength(0.3);
    arrow->SetShaftResolution(16);
    arrow->SetTipResolution(24);
    arrow->Update();
    return actor(arrow->GetOutput(), colour);
}

}  // namespace palpate::visual
