// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/model/body.hpp"
#include "formats/records/tick_result.hpp"
#include "runtime/collision/collision_surface.hpp"
#include "runtime/haptics/contact/contact_scheme.hpp"
#include "runtime/haptics/contact/contact_solver.hpp"
#include "runtime/haptics/contact/deformable_contact.hpp"
#include "runtime/haptics/contact/god_object.hpp"
#include "runtime/haptics/contact/published_contact.hpp"
#include "runtime/haptics/force_limiter.hpp"
#include "runtime/realtime/device.hpp"

namespace palpate {

/// The stiffest virtual coupling that keeps a sampled spring passive on a device (N/mm): the least of what
/// the case asks for, the device's stated maximum, and 2 b / T for a device of damping b read every T = 1 ms
/// (Colgate, Schenkel 1997, without the wall's own damping; Abbott, Okamura 2005). What a device does not
/// state does not limit. Throws InvalidInput if a limit is negative or not finite.
double coupling_stiffness(const HapticSettings& settings, const DeviceLimits& device);

/// A patient ready to be touched: everything is allocated and checked here, so that a tick only computes.
/// `continuous`: a tool is a sphere, or a row of spheres where it has a shaft. Each holds a god-object on the
/// rigid bodies and one on each deformable body; where only the tip touches, and only rigid bodies, the force
/// is that of the virtual coupling, stiffness * (proxy - device), otherwise all contact points are solved
/// together (ContactSolver). The shaft turns as the device says; the torque that would turn it back is not
/// rendered. `single` and `twice`: see PublishedContact; they know one tip.
class HapticModel {
  public:
    /// Copies what it needs of the case; compliances are shared. Throws InvalidInput if the case has no body,
    /// its haptic settings make no sense, or a published scheme is to have several tools. Linear in the
    /// surfaces.
    explicit HapticModel(const Case& patient_case, ContactScheme scheme = ContactScheme::continuous,
                         std::size_t tool_count = 1);

    /// Limits the virtual coupling to what every device bears, coupling_stiffness(), and the force to the
    /// least of their largest ones. Not beside a running tick.
    void couple_to(std::span<const DeviceLimits> devices);
    /// Of the virtual coupling, N/mm.
    double coupling() const noexcept { return coupling_; }

    /// Forgets all contact; every body counts as not yet felt until the tool is clear of it. Not beside a
    /// running tick or detection.
    void reset() noexcept;

    /// Computes the forces for one state of each tool: finds contacts, solves them, limits the forces. Fills
    /// the results except tick_ns, wake_latency_ns and overruns. As many states and results as tools
    /// (asserted). Where a device has a fault, or with any of `faults` (Fault flags) all of them, the force
    /// goes to zero, see ForceLimiter; contacts are followed as long as the position is trusted. A tool that
    /// is found again more than 5 mm away starts anew: it does not feel a body that it is in until it has
    /// been clear of it. One thread; realtime-safe: no allocation, lock or I/O.
    void tick(std::span<const DeviceState> devices, std::span<TickResult> results,
              std::uint32_t faults = no_fault) noexcept;
    /// The same with one tool.
    void tick(const DeviceState& device, TickResult& result) noexcept { tick({&device, 1}, {&result, 1}); }

    /// The published schemes' collision loop, to be called 30 times a second from one thread, which may be
    /// another than tick()'s; nothing for `continuous`.
    void detect() noexcept;
    /// The same for a given position of a given tick, as a replay has it (TickResult::detected_tick).
    void detect_at(const std::array<double, 3>& device, std::int64_t tick) noexcept;

    const HapticSettings& settings() const noexcept { return settings_; }
    ContactScheme scheme() const noexcept { return scheme_; }
    std::size_t tool_count() const noexcept { return tools_.size(); }
    std::size_t body_count() const noexcept { return surfaces_.size(); }
    std::size_t rigid_count() const noexcept { return surfaces_.size() - deformable_.size(); }
    const std::string& body_name(std::size_t body) const { return names_[body]; }
    /// The rest surface of a body. Safe beside a running tick.
    const CollisionSurface& surface(std::size_t body) const { return *surfaces_[body]; }

    /// Writes the displacement (mm) of every surface vertex of deformable body `body` (>= rigid_count())
    /// under the contacts of a tick: u = -sum_k C (f_k n_k + friction_k), zero at fixed nodes.
    /// `displacements` has one entry per surface vertex. Safe beside a running tick; costs 3 m multiply-adds
    /// per touched degree of freedom.
    void surface_displacement(std::size_t body, const TickResult& result,
                              std::span<Eigen::Vector3f> displacements) const noexcept;

  private:
    // A part of a tool on one deformable body.
    struct SoftTouch {
        GodObject god_object;
        double grip = 1;  // what friction's mm of drag hold, against those of press: see friction_of()
        std::span<Contact> contacts{};  // of this tick, in its tool's result
    };
    // A sphere of the tool: its tip, or one of those that stand for its shaft.
    struct Part {
        double behind_tip = 0;  // mm, along the shaft
        GodObject on_rigid;
        GodObject on_all;  // as if nothing gave way: no equilibrium is farther from the device
        std::vector<SoftTouch> on_soft{};
        std::span<Contact> rigid_contacts{};               // of this tick, where they are solved
        Eigen::Vector3d device = Eigen::Vector3d::Zero();  // where the coupling pulls it, mm
        double moved = 0;  // mm, by which other contacts have moved the surfaces beside it
    };
    struct Tool {
        std::vector<Part> parts;  // the tip first
        ForceLimiter limiter;
        std::vector<Contact> last_contacts;  // of the tick before: room for max_contacts, the first are valid
        std::size_t last_count = 0;
        std::size_t parts_felt = 0;  // in this tick: none without a trusted position, the tip alone
                                     // without a shaft's direction
        bool lost = false;           // the last position was not to be trusted
    };

    void begin(Tool& tool, const DeviceState& device, TickResult& result) noexcept;
    static void forget(Tool& tool) noexcept;
    void follow(std::size_t tool, TickResult& result) noexcept;
    void follow_soft(std::size_t tool, std::size_t part, std::size_t soft, TickResult& result) noexcept;
    bool hold_off_rigid(std::span<TickResult> results) noexcept;
    bool within_reach(const Tool& tool, const TickResult& result) const noexcept;
    void add_rigid_contacts(std::size_t tool, TickResult& result) noexcept;
    Eigen::Vector3d moved_by_others(std::size_t tool, std::size_t part, std::size_t soft,
                                    const Eigen::Vector3d& place) const noexcept;
    Contact rigid_contact(const GodObject::Touch& touch, const Eigen::Vector3d& normal,
                          double gap) const noexcept;
    Eigen::Vector3d rigid_force(const GodObject& tip, const Eigen::Vector3d& device,
                                TickResult& result) const noexcept;
    Eigen::Vector3d solved_force(Tool& tool, const TickResult& result) const noexcept;
    Eigen::Vector3d friction_of(const Part& part) const noexcept;
    Eigen::Vector3d friction_of(SoftTouch& touch, const DeformableContact& body) const noexcept;
    void finish(Tool& tool, const Eigen::Vector3d& force, TickResult& result) noexcept;

    HapticSettings settings_;
    ContactScheme scheme_;
    double coupling_;
    Friction friction_;
    std::vector<std::string> names_;
    std::vector<std::unique_ptr<CollisionSurface>> surfaces_;  // rigid bodies first
    std::vector<const CollisionSurface*> rigid_surfaces_, all_surfaces_;
    std::vector<std::vector<Triangle>> rigid_triangles_;  // vertex indices, for the record of contacts
    std::vector<DeformableContact> deformable_;
    std::vector<Tool> tools_;
    ContactSolver solver_;
    std::optional<PublishedContact> published_;
    std::int64_t tick_ = 0;
};

}  // namespace palpate
