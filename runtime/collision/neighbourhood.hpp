// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "runtime/collision/collision_surface.hpp"
#include "runtime/collision/surroundings.hpp"

namespace palpate::collision {

/// The triangles around a slowly moving sphere, gathered from the tree once and then asked many times:
/// between two ticks a tool moves by a tenth of a millimetre, so what was near it still is. The few that are
/// nearest have a plane each that they lie behind; a sphere that stays before it cannot touch them. Such a
/// plane never becomes wrong, and is drawn anew between sphere and triangle where it no longer parts them.
/// Belongs to one sphere on one surface. Realtime-safe: a fixed store, no allocation.
class Neighbourhood {
  public:
    Neighbourhood() { clear(); }
    /// Forgets everything, as if it were new.
    void clear() noexcept;
    /// Forgets what was touched last, so that what is touched next depends on the sweep alone.
    void let_go() noexcept { hint_ = -1; }

    /// The same as surface.sweep_sphere(from, to, radius), to the bit. Gathers anew when the sweep leaves the
    /// neighbourhood, and asks the tree where that would hold too many triangles or the way is long.
    std::optional<SweepContact> sweep_sphere(const CollisionSurface& surface, const Eigen::Vector3d& from,
                                             const Eigen::Vector3d& to, double radius) noexcept;

    /// Once a tick, with the sphere at p (mm): gathers part of what it will need where it is going, so that
    /// no single tick has to gather it all. Changes the cost of sweeps, not what they find.
    void look_ahead(const CollisionSurface& surface, const Eigen::Vector3d& p, double radius) noexcept;

  private:
    static constexpr std::size_t capacity = 64;

    Surroundings& around() noexcept { return surroundings_[current_]; }
    Surroundings& next() noexcept { return surroundings_[1 - current_]; }
    void gather(const CollisionSurface& surface, const Eigen::Vector3d& p, double radius) noexcept;
    bool choose(const CollisionSurface& surface, const Eigen::Vector3d& p, double radius,
                double step) noexcept;
    bool choose_within(const Eigen::Vector3d& p, double reach) noexcept;
    double room(const Eigen::Vector3d& p, double radius) const noexcept {
        return reach_ - radius - (p - origin_).norm();
    }
    bool may_touch(const CollisionSurface& surface, std::size_t at, const Eigen::Vector3d& from,
                   const Eigen::Vector3d& to, double radius) noexcept;
    std::optional<SweepContact> kept(const SweepContact& best) noexcept;
    bool crosses(std::size_t at, const Eigen::Vector3f& a, const Eigen::Vector3f& b,
                 float near) const noexcept;
    void find_hint() noexcept;
    std::optional<SweepContact> sweep_near(const CollisionSurface& surface, const Eigen::Vector3d& from,
                                           const Eigen::Vector3d& way, double radius, double done,
                                           double limit) noexcept;
    std::optional<SweepContact> sweep_around(const CollisionSurface& surface, const Eigen::Vector3d& from,
                                             const Eigen::Vector3d& way, double radius,
                                             double limit) noexcept;

    std::array<Surroundings, 2> surroundings_;  // one to choose from, one that is being gathered
    std::size_t current_ = 0;
    double wide_margin_ = 0;  // mm beyond the sphere; both follow the density of the triangles
    double margin_ = 0;
    Eigen::Vector3d last_ = Eigen::Vector3d::Zero();  // where it looked ahead last
    double step_ = 0;                                 // mm that it had moved by then since the tick before
    std::int32_t hint_ = -1;                          // slot of the last contact

    std::size_t hint_at_ = 0;  // where it is among the chosen; count_ if it is not

    // What was chosen: every triangle within reach_ of origin_, whose plane it lies behind: n . (x - origin_)
    // <= d.
    Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
    double reach_ = -1;  // mm
    std::size_t count_ = 0;
    alignas(16) std::array<float, capacity + lanes> nx_, ny_, nz_, d_;
    std::array<std::int32_t, capacity + lanes> slots_;
};

}  // namespace palpate::collision
