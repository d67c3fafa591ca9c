// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "runtime/collision/collision_surface.hpp"
#include "runtime/collision/neighbourhood.hpp"

namespace palpate::haptics {

/// Coulomb's law: a tool at rest stays until the tangential force is `at_rest` times the normal one, and then
/// drags with `sliding` times it. 0 <= sliding <= at_rest. On tissue, `grip` (N/mm²) comes to both over the
/// area that is pressed.
struct Friction {
    double at_rest = 0;
    double sliding = 0;
    double grip = 0;

    bool any() const noexcept { return at_rest > 0 || grip > 0; }
};

/// A sphere that follows the device but never enters a surface (Zilles, Salisbury 1995, with the finite
/// radius of Ruspini, Kolarov, Khatib 1997). Each move sweeps the sphere from where it was towards the
/// device, stops it at the exact first touch, and lets it slide on in the half-spaces of the surfaces it
/// touched, towards the point nearest to the device; friction ends the slide where the spring to the device
/// would pull less than Coulomb's law holds. It keeps `skin` of clearance beyond its radius, so rounding
/// never lets it through at any speed.
class GodObject {
  public:
    static constexpr double skin = 1e-4;         ///< mm: above rounding (1e-12), below any edge (0.05)
    static constexpr double slide_slack = 0.05;  ///< mm per move
    static constexpr std::size_t max_touches = 4;
    static constexpr double nothing = std::numeric_limits<double>::lowest();  ///< is slipped past

    /// One place where the sphere rests on a surface.
    struct Touch {
        collision::ClosestPoint foot;
        Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< unit, from the foot to the centre
        std::size_t surface = 0;                           ///< index in what move() was given
    };

    /// For `surface_count` surfaces, which move() then gets in one order always. Allocates.
    GodObject(double radius, std::size_t surface_count) : radius_(radius), obstacles_(surface_count) {}

    /// Lets go: the sphere follows the device freely, and a surface counts again once the sphere is clear of
    /// it.
    void reset() noexcept;

    /// Is at `position` (mm) from now on, where somebody knows that it is clear of all surfaces.
    void start_clear_at(const Eigen::Vector3d& position) noexcept;

    /// Is where another of the same radius and surfaces is, touches what that touches, and has been clear of
    /// the same.
    void start_at(const GodObject& other) noexcept;

    /// Moves towards `device` (mm). Returns false while there are surfaces that the tool has not been clear
    /// of yet; these are not felt.
    bool move(std::span<const collision::CollisionSurface* const> surfaces, const Eigen::Vector3d& device,
              const Friction& friction = {}) noexcept;

    /// Where the sphere, on a straight way from its position to `to` (mm), would first touch a surface; it
    /// stays where it is. Not counted is what it only slips past, its end beyond the plane of the touch by no
    /// more than `slight` (mm): the way goes on beside that, by as little as it takes, up to eight times.
    std::optional<Touch> touch_on_the_way(std::span<const collision::CollisionSurface* const> surfaces,
                                          const Eigen::Vector3d& to, double slight = nothing) noexcept;

    /// Goes straight to `to` (mm), or stays where it is if a surface is in the way.
    void settle_at(std::span<const collision::CollisionSurface* const> surfaces,
                   const Eigen::Vector3d& to) noexcept;

    /// Says that no surface is nearer to its centre than `distance` (mm) where it is now: until it leaves
    /// that ball nothing needs to be asked. Changes the cost of moves, not what they find.
    void note_clearance(double distance) noexcept {
        clear_about_ = position_;
        clear_within_ = distance - radius_ - skin;
    }
    /// Whether it is still within what was noted.
    bool is_known_clear() const noexcept { return is_known_clear_at(position_); }

    const Eigen::Vector3d& position() const noexcept { return position_; }
    double radius() const noexcept { return radius_; }
    /// Where the sphere rests on the surface and is held off the device, the nearest first; none if it
    /// reached the device.
    std::span<const Touch> touches() const noexcept { return {touches_.data(), touch_count_}; }
    /// What friction holds back: from the sphere to where it would be without friction, mm.
    const Eigen::Vector3d& held_back() const noexcept { return held_back_; }

  private:
    struct Obstacle {
        collision::Neighbourhood near;
        bool followed = false;  // the tool has been clear of it once
    };
    struct HalfSpace {
        Eigen::Vector3d normal = Eigen::Vector3d::Zero();
        double offset = 0;  // centre x is admissible where normal . x >= offset
        std::int32_t slot = -1;
        std::size_t surface = 0;
    };
    struct Hit {
        collision::SweepContact contact;
        std::size_t surface = 0;
    };
    using Surfaces = std::span<const collision::CollisionSurface* const>;

    bool is_known_clear_at(const Eigen::Vector3d& p) const noexcept {
        return clear_within_ > 0 && (p - clear_about_).squaredNorm() < clear_within_ * clear_within_;
    }
    void let_go() noexcept;
    void slide(Surfaces surfaces, const Eigen::Vector3d& device, const Friction& friction) noexcept;
    std::optional<Hit> sweep(Surfaces surfaces, const Eigen::Vector3d& from,
                             const Eigen::Vector3d& to) noexcept;
    void touch(const Hit& hit, const Eigen::Vector3d& way) noexcept;
    void find_touches(Surfaces surfaces, const Eigen::Vector3d& device) noexcept;
    bool follow_what_is_clear(Surfaces surfaces) noexcept;
    Eigen::Vector3d nearest_admissible(const Eigen::Vector3d& device) noexcept;
    Eigen::Vector3d held_by(const Friction& friction, const Eigen::Vector3d& device,
                            const Eigen::Vector3d& wanted) noexcept;

    double radius_;
    std::vector<Obstacle> obstacles_;
    bool all_followed_ = false, any_followed_ = false;
    bool at_rest_ = true;  // in the sense of friction
    Eigen::Vector3d position_ = Eigen::Vector3d::Zero();
    Eigen::Vector3d last_device_ = Eigen::Vector3d::Zero();
    Eigen::Vector3d held_back_ = Eigen::Vector3d::Zero();
    Eigen::Vector3d clear_about_ = Eigen::Vector3d::Zero();
    double clear_within_ = 0;  // mm: from there its centre may go so far
    std::array<HalfSpace, max_touches> planes_;
    std::size_t plane_count_ = 0;
    std::array<Touch, max_touches> touches_;
    std::size_t touch_count_ = 0;
};

}  // namespace palpate::haptics
