// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/model/body.hpp"
#include "formats/records/tick_result.hpp"
#include "runtime/collision/collision_surface.hpp"
#include "runtime/haptics/contact/contact_bodies.hpp"
#include "runtime/haptics/force_limiter.hpp"
#include "runtime/haptics/methods/contact_method.hpp"
#include "runtime/haptics/methods/contact_methods.hpp"
#include "runtime/haptics/passivity_observer.hpp"
#include "runtime/realtime/device.hpp"

namespace palpate::haptics {

/// The stiffest virtual coupling that keeps a sampled spring passive on a device (N/mm): the least of what
/// the case asks for, the device's stated maximum, and 2 b / T for a device of damping b read every T = 1 ms
/// (Colgate, Schenkel 1997, without the wall's own damping; Abbott, Okamura 2005). What a device does not
/// state does not limit. Throws InvalidInput if a limit is negative or not finite.
double coupling_stiffness(const HapticSettings& settings, const DeviceLimits& device);

/// The same of the spring that turns a tool, N mm/rad, of a device that renders torque; another's does not
/// limit it.
double torsional_stiffness(const ToolSettings& settings, const DeviceLimits& device);

/// A patient ready to be touched: everything is allocated and checked here, so that a tick only computes. How
/// contact is found and answered is a ContactMethod's; faults, coupling and limits are the same for all.
class HapticModel {
  public:
    /// `method`: a name of contact_methods(). Copies what it needs of the case; compliances are shared.
    /// Throws InvalidInput if the case has no body, its haptic settings or its tool's make no sense, or the
    /// method takes fewer tools; UsageError if there is no such method. Linear in the surfaces.
    explicit HapticModel(const Case& patient_case, std::string_view method = usual_contact_method,
                         std::size_t tool_count = 1);
    HapticModel(const HapticModel&) = delete;
    HapticModel& operator=(const HapticModel&) = delete;

    /// Limits the virtual coupling to what every device bears, coupling_stiffness() and
    /// torsional_stiffness(), and force and torque to the least of their largest ones. `devices`: of the
    /// tools, in their order. Throws InvalidInput for limits that make no sense. Not beside a running tick.
    void couple_to(std::span<const DeviceLimits> devices);
    /// Of the virtual coupling, N/mm.
    double coupling() const noexcept { return coupling_.stiffness; }
    /// The same of what turns a tool that turns by itself, N mm/rad.
    double torsional_coupling() const noexcept { return coupling_.torsional_stiffness; }
    /// Whether its tools turn by themselves, so that there is torque.
    bool turns() const noexcept { return turns_; }
    /// Whether the devices of all its tools, as it was coupled to them, render that torque.
    bool torque_is_felt() const noexcept;

    /// Forgets all contact; every body counts as not yet felt until the tool is clear of it. Not beside a
    /// running tick or detection.
    void reset() noexcept;

    /// The number of its next tick, and numbers it so. Not beside a running tick.
    std::int64_t next_tick() const noexcept { return tick_; }
    void count_from(std::int64_t tick) noexcept { tick_ = tick; }

    /// Computes the forces for one state of each tool: finds contacts, solves them, limits the forces. Fills
    /// the results except tick_ns, wake_latency_ns and overruns. As many states and results as tools
    /// (asserted). Where a device has a fault, or with any of `faults` (Fault flags) all of them, the force
    /// goes to zero, see ForceLimiter; contacts are followed as long as the position is trusted. A tool that
    /// is found again more than 5 mm away, or turned by more than 20 degrees, starts anew: it does not feel a
    /// body that it is in until it has been clear of it. One thread; realtime-safe: no allocation, lock or
    /// I/O.
    void tick(std::span<const realtime::DeviceState> devices, std::span<TickResult> results,
              std::uint32_t faults = no_fault) noexcept;
    /// The same with one tool.
    void tick(const realtime::DeviceState& device, TickResult& result) noexcept {
        tick({&device, 1}, {&result, 1});
    }

    /// What detect() answers.
    Detects detects() const noexcept { return contact_->detects(); }
    /// The collision loop where there is something to detect, to be called once a period
    /// (CollisionLoop::period_of()) from one thread, which may be another than tick()'s; nothing elsewhere.
    void detect() noexcept;
    /// The same for a given position of a given tick, as a replay (TickResult::detected_tick) or a loop that
    /// is late has it; or for the forces of that tick, where this model keeps them.
    void detect_at(const std::array<double, 3>& device, std::int64_t tick) noexcept;

    /// From now on the forces of the last remembered_ticks are kept for detect_at(). Allocates; not beside a
    /// running tick or detection.
    void keep_forces() { contact_->keep_forces(); }

    /// Free ticks after which nothing is left of a touch where tissue creeps; 0 where nothing does.
    std::int64_t memory_ticks() const noexcept;
    const HapticSettings& settings() const noexcept { return settings_; }
    /// Its line in the table of contact methods: name and capabilities.
    const ContactMethodEntry& method() const noexcept { return method_; }
    /// How far the tool goes beyond its tip's centre, mm: its radius, or how far its body does against the
    /// shaft; 0 where the method knows a point.
    double contact_radius() const noexcept { return contact_radius_; }
    /// What stands for a tool, where that is spheres, in its frame T.
    std::span<const ToolSphere> tool_spheres() const noexcept { return contact_->spheres(); }
    std::size_t tool_count() const noexcept { return tools_.size(); }
    std::size_t body_count() const noexcept { return bodies_.surfaces.size(); }
    std::size_t rigid_count() const noexcept { return bodies_.rigid_count(); }
    const std::string& body_name(std::size_t body) const { return bodies_.names[body]; }
    /// The rest surface of a body. Safe beside a running tick.
    const collision::CollisionSurface& surface(std::size_t body) const { return *bodies_.surfaces[body]; }

    /// How far what a tool feels of a body at rest lies below a point of that surface, whose edges it feels
    /// round, mm; 0 of rigid bodies. Safe beside a running tick.
    double cut_off(std::size_t body, const collision::ClosestPoint& foot) const noexcept {
        return body < rigid_count() ? 0 : bodies_.deformable[body - rigid_count()].cut_off(foot);
    }

    /// Writes the displacement (mm) of every surface vertex of deformable body `body` (>= rigid_count())
    /// under the contacts of a tick: u = -sum_k C (f_k n_k + friction_k), + where it presses a neighbour
    /// (Contact::other_body), zero at fixed nodes. What earlier contacts left behind where tissue creeps is
    /// not in it: DrawnCreep.
    /// `displacements` has one entry per surface vertex. Safe beside a running tick; costs 3 m multiply-adds
    /// per touched degree of freedom.
    void surface_displacement(std::size_t body, const TickResult& result,
                              std::span<Eigen::Vector3f> displacements) const noexcept;
    /// Adds what the contacts of all tools displace it by beyond its compliance, where it is hyperelastic and
    /// this model ticks. For one thread, beside a running tick.
    void add_beyond(std::size_t body, std::span<const TickResult* const> results,
                    std::span<Eigen::Vector3f> displacements) const {
        contact_->add_beyond(body - rigid_count(), results, displacements);
    }

  private:
    struct Tool {
        ForceLimiter limiter, torque_limiter;
        ContactPose last{};         // that was to be trusted
        bool lost = false;          // the last position was not
        bool feels_torque = false;  // its device renders it
    };

    ContactPose begin(Tool& tool, const realtime::DeviceState& device, TickResult& result) noexcept;

    HapticSettings settings_;
    ToolSettings tool_settings_;
    const ContactMethodEntry& method_;
    VirtualCoupling coupling_;
    double contact_radius_;
    bool turns_;  // tools, by themselves
    ContactBodies bodies_;
    std::vector<Tool> tools_;
    std::vector<ContactPose> poses_;  // of this tick, as are the forces
    std::vector<Eigen::Vector3d> forces_;
    std::unique_ptr<ContactMethod> contact_;
    PassivityObserver observer_;
    std::int64_t tick_ = 0;
};

}  // namespace palpate::haptics
