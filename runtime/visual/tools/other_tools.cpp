// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/tools/other_tools.hpp"

#include <algorithm>
#include <cmath>
#include <vtkProperty.h>
#include <vtkShaderProperty.h>

#include "runtime/visual/actors.hpp"
#include "runtime/visual/tools/tool_shapes.hpp"

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

}  // namespace

OtherTools::OtherTools(const OtherToolLook& look, vtkRenderer* renderer, vtkRenderer* front)
    : look_(look), renderer_(renderer), front_(front) {}

OtherTools::Actors OtherTools::make(OtherTool::Kind kind) const {
    const bool ghost = kind == OtherTool::Kind::ghost, jaw = kind == OtherTool::Kind::jaw;
    const Rgb &tip = ghost ? ghost_colour : jaw ? held_blue : tool_colour, &shaft = jaw ? steel : tip;
    Actors actors{.kind = kind,
                  .ball = ball(look_.radius, tip, 20),
                  .shaft = tool_shaft(look_.radius, look_.shaft_length, shaft),
                  .arrow = force_arrow(ghost ? ghost_arrow_width : 1, tip)};
    for (const auto& part : {actors.ball, actors.shaft, actors.arrow}) {
        if (!jaw) {  // a jaw is lit as the held tool is
            part->GetProperty()->SetAmbient(0.4);
            part->GetProperty()->SetDiffuse(0.6);
        }
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
            actors_.push_back(make(tools[i].kind));
        } else if (actors_[i].kind != tools[i].kind) {
            remove(actors_[i]);
            actors_[i] = make(tools[i].kind);
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
