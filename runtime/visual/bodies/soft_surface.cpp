// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/bodies/soft_surface.hpp"

#include <vtkProperty.h>

#include "runtime/visual/tissue/tissue_actor.hpp"

namespace palpate::visual {

SoftSurface::SoftSurface(const DeformableBody& body, const Eigen::Vector3d& toward_eye, double grain,
                         const StiffnessMap& map, vtkRenderer* renderer)
    : surface_(body.boundary.surface, toward_eye),
      grained_(grained_tissue_actor(surface_.data(), look_of(body), grain)),
      plain_(tissue_actor(surface_.data(), look_of(body))),
      mapped_(map.actor_of(body, surface_.data())) {
    for (vtkActor* actor : actors()) renderer->AddActor(actor);
    choose();
}

std::vector<vtkActor*> SoftSurface::actors() const {
    std::vector<vtkActor*> all{grained_, plain_};
    if (mapped_) all.push_back(mapped_);
    return all;
}

void SoftSurface::choose() {
    vtkActor* shown = mapped_ && stiffness_shown_ ? mapped_ : grain_shown_ ? grained_ : plain_;
    for (vtkActor* actor : actors()) actor->SetVisibility(actor == shown);
}

void SoftSurface::show_grain(bool on) {
    grain_shown_ = on;
    choose();
}

void SoftSurface::show_stiffness(bool on) {
    stiffness_shown_ = on;
    choose();
}

void SoftSurface::show_inside(bool on) {
    for (vtkActor* actor : actors()) actor->GetProperty()->SetBackfaceCulling(!on);
}

}  // namespace palpate::visual
