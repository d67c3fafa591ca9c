// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <optional>
#include <span>

#include "runtime/collision/collision_surface.hpp"
#include "runtime/visual/sight.hpp"

namespace palpate::visual {

/// Chooses a sight of a place on a passage's wall (`point` p_P in mm, `normal` unit, out of the wall) from
/// inside the passage, as an endoscope has it: 70 degrees wide, with the target in the middle and nothing
/// between. Of some thousand directions over the wall it is the one along which a lens of 1.5 mm backs out
/// farthest, steep ones before grazing ones, and of the way's farther part the place with most room, at most
/// 45 mm away. Nothing where it backs out less than 15 mm. The same for the same surfaces. Cost: a sweep of
/// each surface for each direction.
std::optional<Sight> choose_passage_sight(std::span<const collision::CollisionSurface* const> surfaces,
                                          const Eigen::Vector3d& point, const Eigen::Vector3d& normal);

}  // namespace palpate::visual
