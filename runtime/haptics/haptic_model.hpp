// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "formats/model/body.hpp"
#include "runtime/collision/collision_surface.hpp"
#include "runtime/haptics/deformable_contact.hpp"
#include "runtime/haptics/force_limiter.hpp"
#include "runtime/haptics/god_object.hpp"
#include "runtime/haptics/tick_result.hpp"
#include "runtime/realtime/device.hpp"

namespace palpate {

/// A patient ready to be touched: everything is allocated and checked here, so that a tick only computes.
/// Each body holds its own god-object; their forces add. Rigid bodies answer with
/// force = coupling_stiffness * (proxy - device), deformable ones with exact unilateral contact on their
/// compliance (DeformableContact).
class HapticModel {
  public:
    /// Copies what it needs of the case; compliances are shared. Throws InvalidInput if the case has no body
    /// or its haptic settings make no sense. Linear in the surfaces.
    explicit HapticModel(const Case& patient_case);

    /// Forgets all contact; every body counts as not yet felt until the tool is clear of it.
    void reset() noexcept;

    /// Computes the force for one device state: finds contacts, solves them, limits the force. Fills `result`
    /// except tick_ns, wake_latency_ns and overruns. One thread; realtime-safe: no allocation, lock or I/O.
    void tick(const DeviceState& device, TickResult& result) noexcept;

    const HapticSettings& settings() const noexcept { return settings_; }
    std::size_t body_count() const noexcept { return surfaces_.size(); }
    std::size_t rigid_count() const noexcept { return surfaces_.size() - deformable_.size(); }
    const std::string& body_name(std::size_t body) const { return names_[body]; }
    /// The rest surface of a body. Safe beside a running tick.
    const CollisionSurface& surface(std::size_t body) const { return *surfaces_[body]; }

    /// Writes the displacement (mm) of every surface vertex of deformable body `body` (>= rigid_count())
    /// under the contacts of a tick: u = -sum_k f_k sum_i w_ki C_:i n_k, zero at fixed nodes. `displacements`
    /// has one entry per surface vertex. Safe beside a running tick; costs 3 m multiply-adds per touched
    /// degree of freedom.
    void surface_displacement(std::size_t body, const TickResult& result,
                              std::span<Eigen::Vector3f> displacements) const noexcept;

  private:
    Eigen::Vector3d touch_rigid(std::size_t body, const Eigen::Vector3d& device, double depth,
                                TickResult& result) noexcept;
    Eigen::Vector3d touch_deformable(std::size_t body, const Eigen::Vector3d& device,
                                     TickResult& result) noexcept;

    HapticSettings settings_;
    std::vector<std::string> names_;
    std::vector<std::unique_ptr<CollisionSurface>> surfaces_;  // rigid bodies first
    std::vector<GodObject> god_objects_;                       // one per body
    std::vector<std::vector<Triangle>> rigid_triangles_;       // vertex indices, for the record of contacts
    std::vector<DeformableContact> deformable_;
    ForceLimiter limiter_;
    std::int64_t tick_ = 0;
};

}  // namespace palpate
