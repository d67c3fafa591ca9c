// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>

#include "runtime/collision/collision_surface.hpp"

namespace palpate::visual {

/// Where a tool would touch: its shadow on the rest surface nearest to it, all p_P, mm.
struct DropMark {
    static constexpr std::size_t ring_points = 40;
    Eigen::Vector3d foot = Eigen::Vector3d::Zero();  ///< on the surface, just above it
    double gap = 0;                                  ///< mm, between tool and surface
    std::array<Eigen::Vector3d, ring_points> ring;   ///< around the foot, draped over the surface
};

/// Finds the mark of a tool of `radius` at `tool` (p_P, mm). The ring's radius is the tool's and half the
/// gap: it closes as the tool comes down. Nothing where no surface lies within `reach` (mm) of the tool, or
/// it touches one: where it is then needs no telling. Cost: one query of each surface and 40 of one.
std::optional<DropMark> drop_mark(std::span<const collision::CollisionSurface* const> surfaces,
                                  const Eigen::Vector3d& tool, double radius, double reach);

}  // namespace palpate::visual
