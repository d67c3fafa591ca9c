// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/bodies/rigid_surface.hpp"

#include <algorithm>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>

#include "runtime/visual/bodies/display_copy.hpp"
#include "runtime/visual/tissue/tissue_actor.hpp"

namespace palpate::visual {

RigidSurface::RigidSurface(const RigidBody& body, const Sight& sight, std::int64_t budget,
                           vtkRenderer* renderer)
    : sight_(sight),
      copy_(display_copy(body.surface, budget, sight.close_up, sight.close_up_radius)),
      fine_(poly_data(copy_, sight.toward_eye)),
      actor_(tissue_actor(fine_, look_of(body))),
      section_(body.surface, look_of(body), renderer) {
    actor_->GetProperty()->BackfaceCullingOn();
    renderer->AddActor(actor_);
}

void RigidSurface::show_fine(bool on) {
    if (!on && !coarse_) {
        const auto quarter = std::max<std::int64_t>(1, static_cast<std::int64_t>(copy_.triangles.size() / 4));
        coarse_ = poly_data(display_copy(copy_, quarter, sight_.close_up, sight_.close_up_radius),
                            sight_.toward_eye);
    }
    vtkPolyDataMapper::SafeDownCast(actor_->GetMapper())->SetInputData(on ? fine_ : coarse_);
}

void RigidSurface::show(bool on) {
    shown_ = on;
    actor_->SetVisibility(on);
}

}  // namespace palpate::visual
