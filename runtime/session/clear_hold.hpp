// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <optional>
#include <span>

#include "formats/model/body.hpp"
#include "runtime/collision/collision_surface.hpp"

namespace palpate::session {

/// How the case's tool is held with its tip there (p_P, mm), R_PT: along `normal` (unit) where none of the
/// `bodies` is in the way of its shaft, as thick as the tool is anywhere; else along the direction over that
/// half space that is nearest to it of some thousand in which none is, or, where there is none, in which one
/// is farthest away. It keeps 4 mm clear of `eye`, p_P, mm. Cost: a sweep of each body for each direction.
Eigen::Quaterniond clear_hold(const Case& patient_case,
                              std::span<const collision::CollisionSurface* const> bodies,
                              const Eigen::Vector3d& tip, const Eigen::Vector3d& normal,
                              const std::optional<Eigen::Vector3d>& eye = std::nullopt);

}  // namespace palpate::session
