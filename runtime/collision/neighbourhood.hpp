// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "runtime/collision/collision_surface.hpp"

namespace palpate::collision {

/// The triangles around a slowly moving sphere, gathered from the tree once and then asked many times:
/// between two ticks a tool moves by a tenth of a millimetre, so what was near it still is. Belongs to one
/// sphere on one surface. Realtime-safe: a fixed store, no allocation.
class Neighbourhood {
  public:
    /// Forgets everything, as if it were new.
    void clear() noexcept {
        reach_ = -1;
        margin_ = first_margin;
        hint_ = nearest_ = -1;
        count_ = 0;
    }
    /// Forgets what was touched last, so that what is touched next depends on the sweep alone.
    void let_go() noexcept { hint_ = -1; }

    /// The same as surface.sweep_sphere(from, to, radius): the same fraction and point; where several
    /// triangles are touched at once, the slot may be another. Gathers anew when the sweep leaves the
    /// neighbourhood, and asks the tree where that would hold too many triangles or the way is long.
    std::optional<SweepContact> sweep_sphere(const CollisionSurface& surface, const Eigen::Vector3d& from,
                                             const Eigen::Vector3d& to, double radius) noexcept;

  private:
    static constexpr std::size_t capacity = 256, lanes = 4;
    static constexpr double first_margin = 0.3;  // mm

    bool gather(const CollisionSurface& surface, const Eigen::Vector3d& centre, double radius,
                double step) noexcept;
    void take(const CollisionSurface& surface, std::size_t at, std::int32_t slot) noexcept;
    double room(const Eigen::Vector3d& p, double radius) const noexcept;
    std::optional<SweepContact> sweep_gathered(const CollisionSurface& surface, const Eigen::Vector3d& from,
                                               const Eigen::Vector3d& way, double radius,
                                               double limit) noexcept;

    Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();
    double reach_ = -1;  // mm: whatever is within it of the centre is gathered; negative for nothing
    double margin_ = first_margin;  // mm beyond the sphere; follows the density of the triangles
    std::int32_t hint_ = -1;        // slot of the last contact
    std::int32_t nearest_ = -1;     // slot of what was last nearest or touched
    std::size_t count_ = 0;
    // In lanes of four: the smallest circles around the triangles, centres relative to centre_, and unit
    // normals.
    alignas(16) std::array<float, capacity> x_, y_, z_, circle_, nx_, ny_, nz_;
    std::array<std::int32_t, capacity> slots_;
};

}  // namespace palpate::collision
