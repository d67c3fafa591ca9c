// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <optional>
#include <span>

#include "runtime/collision/collision_surface.hpp"

namespace palpate::visual {

/// A place on a body that the eye sees.
struct SeenPoint {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();    ///< on the rest surface, p_P, mm
    Eigen::Vector3d normal = Eigen::Vector3d::UnitZ();  ///< unit, outwards
    Eigen::Vector3d seen_from =
        Eigen::Vector3d::Zero();  ///< p_P, mm; nothing stands between it and the point
};

/// Finds what the line of sight `from`-`to` (p_P, mm) meets first, unless it comes out of a body there, as
/// behind a cut; where `insides_drawn` is not set, it goes on through that, as the picture does. The normal
/// is the mean over places up to `width` (mm) around, along both axes across the line, which belong to the
/// same side: as a tool of that size meets the surface, not as one triangle lies.
std::optional<SeenPoint> surface_under(std::span<const collision::CollisionSurface* const> surfaces,
                                       const Eigen::Vector3d& from, const Eigen::Vector3d& to, double width,
                                       bool insides_drawn = true);

/// Whether a ball of `radius` (mm) on the way `from`-`to` (p_P, mm) meets a surface.
bool is_blocked(std::span<const collision::CollisionSurface* const> surfaces, const Eigen::Vector3d& from,
                const Eigen::Vector3d& to, double radius);

}  // namespace palpate::visual
