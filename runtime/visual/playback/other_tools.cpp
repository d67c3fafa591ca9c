// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/playback/other_tools.hpp"

#include <algorithm>
#include <cmath>
#include <vtkArrowSource.h>
#include <vtkLineSource.h>
#include <vtkNew.h>
#include <vtkProperty.h>
#include <vtkShaderProperty.h>
#include <vtkSphereSource.h>
#include <vtkTubeFilter.h>

#include "runtime/visual/actors.hpp"

namespace palpate::visual {
namespace {

// Orange and bluish green beside the held tool's blue: told apart by colour-blind people too (Okabe, Ito
// 2008).
const Rgb ghost_colour(255, 178, 60), tool_colour(0, 158, 115);
constexpr double ghost_arrow_width = 0.6;  // of a held tool's

// Leaves out every other pixel.
void make_sieve(vtkActor* actor) {
    actor->GetShaderProperty()->AddFragmentShaderReplacement(
        "//VTK::Light::Impl", true,
        "//VTK::Light::Impl\n"
        "  if (mod(floor(gl_FragCoord.x) + floor(gl_FragCoord.y), 2.0) < 0.5) discard;\n",
        false);
}

vtkSmartPointer<vtkActor> sphere_of(double radius, const Rgb& colour) {
    vtkNew<vtkSphereSource> sphere;
    sphere->SetRadius(radius);
    sphere->SetThetaResolution(20);
    sphere->SetPhiResolution(20);
    sphere->Update();
    return actor(sphere->GetOutput(), colour);
}

// Along the x axis.
vtkSmartPointer<vtkActor> shaft_of(const OtherToolLook& look, const Rgb& colour) {
    vtkNew<vtkLineSource> axis;
    axis->SetPoint1(0, 0, 0);
    axis->SetPoint2(look.shaft_length, 0, 0);
    vtkNew<vtkTubeFilter> tube;
    tube->SetInputConnection(axis->GetOutputPort());
    tube->SetRadius(0.4 * look.radius);
    tube->SetNumberOfSides(12);
    tube->CappingOn();
    tube->Update();
    return actor(tube->GetOutput(), colour);
}

// 1 long, along the x axis.
vtkSmartPointer<vtkActor> arrow_of(double width, const Rgb& colour) {
    vtkNew<vtkArrowSource> arrow;
    arrow->SetShaftRadius(0.045 * width);
    arrow->SetTipRadius(0.11 * width);
    arrow->SetTipLength(0.3);
    arrow->SetShaftResolution(12);
    arrow->SetTipResolution(16);
    arrow->Update();
    return actor(arrow->GetOutput(), colour);
}

}  // namespace

OtherTools::OtherTools(const OtherToolLook& look, vtkRenderer* renderer, vtkRenderer* front)
    : look_(look), renderer_(renderer), front_(front) {}

OtherTools::Actors OtherTools::make(bool ghost) const {
    const Rgb& colour = ghost ? ghost_colour : tool_colour;
    Actors actors{.ghost = ghost,
                  .ball = sphere_of(look_.radius, colour),
                  .shaft = shaft_of(look_, colour),
                  .arrow = arrow_of(ghost ? ghost_arrow_width : 1, colour)};
    for (const auto& part : {actors.ball, actors.shaft, actors.arrow}) {
        part->GetProperty()->SetAmbient(0.4);
        part->GetProperty()->SetDiffuse(0.6);
        if (ghost) make_sieve(part);
    }
    for (const auto& part : {actors.ball, actors.shaft}) renderer_->AddActor(part);
    front_->AddActor(actors.arrow);
    return actors;
}

void OtherTools::remove(const Actors& actors) {
    for (const auto& part : {actors.ball, actors.shaft}) renderer_->RemoveActor(part);
    front_->RemoveActor(actors.arrow);
}

void OtherTools::update(std::span<const OtherTool> tools) {
    for (std::size_t i = 0; i < tools.size(); ++i) {
        if (i == actors_.size()) {
            actors_.push_back(make(tools[i].ghost));
        } else if (actors_[i].ghost != tools[i].ghost) {
            remove(actors_[i]);
            actors_[i] = make(tools[i].ghost);
        }
        place(actors_[i], tools[i]);
    }
    for (; actors_.size() > tools.size(); actors_.pop_back()) remove(actors_.back());
}

void OtherTools::place(const Actors& actors, const OtherTool& tool) const {
    constexpr double felt = 0.01;  // N
    place_along(actors.ball, tool.position, Eigen::Vector3d::UnitX(), 1);
    place_along(actors.shaft, tool.position, tool.shaft.isZero() ? look_.shaft_way : tool.shaft, 1);
    const double newtons = tool.force.norm();
    actors.arrow->SetVisibility(newtons > felt);
    if (newtons <= felt) return;
    const Eigen::Vector3d way = tool.force / newtons;
    place_along(actors.arrow, tool.position + way * look_.radius, way,
                look_.arrow_length * std::sqrt(std::min(1.0, newtons / look_.max_force)));
}

}  // namespace palpate::visual
