// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>

#include "runtime/collision/collision_surface.hpp"
#include "runtime/collision/lanes.hpp"

namespace palpate::collision {

/// mm by which float32 may be off, a few millimetres from the centre; a fifth of the god-object's skin.
inline constexpr float float_error = 2e-5F;
/// The same for a triangle's plane, relative to the radius of its disc.
inline constexpr float plane_error = 1e-6F;

/// The triangles within reach of a point, by their discs, gathered from the tree at once or over several
/// ticks. Where there are more than it holds, the reach shrinks. Realtime-safe: a fixed store, no allocation.
class Surroundings {
  public:
    static constexpr std::size_t capacity = 256;

    void clear() noexcept {
        reach_ = -1;
        count_ = 0;
        walk_.pending = 0;
    }
    /// Begins to gather what is within radius + margin of p (mm).
    void begin(const CollisionSurface& surface, const Eigen::Vector3d& p, double radius,
               double margin) noexcept;
    /// Goes on over at most `nodes` nodes of the tree. Until no more is under way, there is no room.
    void go_on(const CollisionSurface& surface, int nodes) noexcept;
    bool under_way() const noexcept { return walk_.pending > 0; }

    /// How far a sphere about p may move and still have all it can touch gathered, mm; negative if it has
    /// not.
    double room(const Eigen::Vector3d& p, double radius) const noexcept {
        return reach_ - radius - (p - centre_).norm();
    }
    const Eigen::Vector3d& centre() const noexcept { return centre_; }
    std::size_t count() const noexcept { return count_; }
    /// By how much it reaches beyond the sphere, mm: less than was asked for where it had to shrink.
    double margin() const noexcept { return static_cast<double>(walk_.reach) - radius_; }
    std::int32_t slot(std::size_t at) const noexcept { return slots_[at]; }

    /// Four triangles at `first`: their discs' centres relative to centre(), radii and normals. Beyond the
    /// last triangle, radii are negative.
    struct Four {
        Float4 x, y, z, circle, nx, ny, nz;
    };
    Four four(std::size_t first) const noexcept {
        return {load(&x_[first]),  load(&y_[first]),  load(&z_[first]), load(&circle_[first]),
                load(&nx_[first]), load(&ny_[first]), load(&nz_[first])};
    }

  private:
    void take(const TriangleDisc& disc, std::int32_t slot) noexcept;
    void shrink() noexcept;
    void finish() noexcept;

    Eigen::Vector3d centre_ = Eigen::Vector3d::Zero();  // rounded to float32
    double radius_ = 0;                                 // of the sphere
    double reach_ = -1;  // mm: whatever is within it of the centre is gathered; negative until it is
    std::size_t count_ = 0;
    NearWalk walk_;
    alignas(16) std::array<float, capacity + lanes> x_, y_, z_, circle_, nx_, ny_, nz_, bound_;
    std::array<std::int32_t, capacity + lanes> slots_;
};

}  // namespace palpate::collision
