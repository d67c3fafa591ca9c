// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>

#include "runtime/collision/collision_surface.hpp"

namespace palpate {

/// A frictionless sphere that follows the device but never enters a surface (Zilles, Salisbury 1995, with the
/// finite radius of Ruspini, Kolarov, Khatib 1997). Each move sweeps the sphere from where it was towards the
/// device, stops it at the exact first touch, and lets it slide on in the half-spaces of the surfaces it
/// touched, towards the point nearest to the device. It keeps `skin` of clearance beyond its radius, so
/// rounding never lets it through at any speed.
class GodObject {
  public:
    static constexpr double skin = 1e-4;         ///< mm: above rounding (1e-12), below any edge (0.05)
    static constexpr double slide_slack = 0.05;  ///< mm per move
    static constexpr std::size_t max_touches = 4;

    /// One place where the sphere rests on the surface.
    struct Touch {
        ClosestPoint foot;
        Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< unit, from the foot to the centre
    };

    explicit GodObject(double radius) noexcept : radius_(radius) {}

    /// Lets go: the sphere follows the device freely until it is clear of the surface once.
    void reset() noexcept { following_ = false; }

    /// Moves towards `device` (mm). Returns false while the tool has not been clear of the surface yet; then
    /// the sphere is at the device and nothing is felt.
    bool move(const CollisionSurface& surface, const Eigen::Vector3d& device) noexcept;

    const Eigen::Vector3d& position() const noexcept { return position_; }
    double radius() const noexcept { return radius_; }
    /// Where the sphere rests on the surface and is held off the device; none if it reached the device.
    std::span<const Touch> touches() const noexcept { return {touches_.data(), touch_count_}; }

  private:
    struct HalfSpace {
        Eigen::Vector3d normal = Eigen::Vector3d::Zero();
        double offset = 0;  // centre x is admissible where normal . x >= offset
        std::int32_t slot = -1;
    };
    void slide(const CollisionSurface& surface, const Eigen::Vector3d& device) noexcept;
    void touch(const SweepContact& contact, const Eigen::Vector3d& way) noexcept;
    void find_touches(const CollisionSurface& surface, const Eigen::Vector3d& device) noexcept;
    Eigen::Vector3d nearest_admissible(const Eigen::Vector3d& device) noexcept;

    double radius_;
    bool following_ = false;
    Eigen::Vector3d position_ = Eigen::Vector3d::Zero();
    Eigen::Vector3d last_device_ = Eigen::Vector3d::Zero();
    std::int32_t hint_ = -1;
    std::array<HalfSpace, max_touches> planes_;
    std::size_t plane_count_ = 0;
    std::array<Touch, max_touches> touches_;
    std::size_t touch_count_ = 0;
};

}  // namespace palpate
