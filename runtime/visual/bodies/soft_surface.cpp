// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/bodies/soft_surface.hpp"

#include <vtkProperty.h>

#include "runtime/visual/bodies/tissue_actor.hpp"

namespace palpate::visual {

SoftSurface::SoftSurface(const DeformableBody& body, const Eigen::Vector3d& toward_eye, double grain,
                         vtkRenderer* renderer)
    : surface_(body.boundary.surface, toward_eye),
      grained_(grained_tissue_actor(surface_.data(), look_of(body), grain)),
      plain_(tissue_actor(surface_.data(), look_of(body))) {
    for (const auto& actor : {grained_, plain_}) renderer->AddActor(actor);
    show_grain(true);
}

void SoftSurface::show_grain(bool on) {
    grained_->SetVisibility(on);
    plain_->SetVisibility(!on);
}

void SoftSurface::show_inside(bool on) {
    for (const auto& actor : {grained_, plain_}) actor->GetProperty()->SetBackfaceCulling(!on);
}

}  // namespace palpate::visual
