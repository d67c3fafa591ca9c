// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/hand/pointed_scene.hpp"

#include "runtime/visual/hand/surface_under.hpp"
#include "runtime/visual/hand/view_control.hpp"

namespace palpate::visual {

using Eigen::Vector3d;

PointerScene pointed_scene(vtkRenderer* renderer,
                           std::span<const collision::CollisionSurface* const> surfaces, double tool_radius,
                           bool insides_drawn) {
    return {.under = [=](const Eigen::Vector2d& pixel) -> std::optional<SeenPoint> {
                const auto [near, far] = segment_under(renderer, pixel.x(), pixel.y());
                return surface_under(surfaces, near, far, tool_radius, insides_drawn);
            },
            .blocked = [=](const Vector3d& from,
                           const Vector3d& to) { return is_blocked(surfaces, from, to, tool_radius); }};
}

}  // namespace palpate::visual
