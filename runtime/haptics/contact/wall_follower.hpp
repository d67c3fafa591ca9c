// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <span>

#include "runtime/collision/collision_surface.hpp"
#include "runtime/haptics/contact/fixed_list.hpp"
#include "runtime/haptics/contact/god_object.hpp"

namespace palpate::haptics {

/// A sphere that goes along with a tool where tissue pushes it, as far as rigid bodies let it, and the walls
/// that it meets there: of each triangle beside it the half-space that keeps it off, as it is seen from where
/// the sphere is. Allocates on construction only.
class WallFollower {
  public:
    using Surfaces = std::span<const collision::CollisionSurface* const>;
    static constexpr std::size_t most_walls = 12;

    /// Of `radius` (mm), for `surface_count` rigid surfaces, which go() then gets in one order always.
    WallFollower(double radius, std::size_t surface_count) : sphere_(radius, surface_count) {}

    /// Begins where another sphere rests on the same surfaces.
    void start_at(const GodObject& rest) noexcept;
    /// Goes on towards `to` (mm). Walls that it has met stay as long as they are beside it; where they are
    /// too many, the nearest.
    void go(Surfaces surfaces, const Eigen::Vector3d& to) noexcept;

    const GodObject& sphere() const noexcept { return sphere_; }
    GodObject& sphere() noexcept { return sphere_; }
    std::span<const GodObject::Touch> walls() const noexcept { return {walls_.data(), walls_.size()}; }
    /// How far beyond a wall, with the skin, a centre at p (mm) is.
    double beyond(const GodObject::Touch& wall, const Eigen::Vector3d& p) const noexcept {
        return wall.normal.dot(wall.foot.point - p) + sphere_.radius() + GodObject::skin;
    }
    /// Whether the sphere touches it, and is not only beside it.
    bool touches(const GodObject::Touch& wall) const noexcept;

  private:
    void add(const GodObject::Touch& wall) noexcept;

    GodObject sphere_;
    FixedList<GodObject::Touch, most_walls> walls_;
};

}  // namespace palpate::haptics
