// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <vtkRenderer.h>

#include "runtime/collision/collision_surface.hpp"
#include "runtime/visual/hand/pointer_hand.hpp"

namespace palpate::visual {

/// What a tool of that radius (mm) can be led over by a pointer: bodies at rest, as the renderer's camera
/// sees them. `insides_drawn`: see surface_under(). What is passed must outlive what is returned.
PointerScene pointed_scene(vtkRenderer* renderer,
                           std::span<const collision::CollisionSurface* const> surfaces, double tool_radius,
                           bool insides_drawn);

}  // namespace palpate::visual
