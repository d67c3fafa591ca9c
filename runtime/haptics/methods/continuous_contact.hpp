// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "formats/model/body.hpp"
#include "runtime/collision/collision_surface.hpp"
#include "runtime/haptics/contact/contact_bodies.hpp"
#include "runtime/haptics/contact/equilibrium/contact_equilibrium.hpp"
#include "runtime/haptics/contact/god_object.hpp"
#include "runtime/haptics/contact/large/large_deformation.hpp"
#include "runtime/haptics/contact/wall_follower.hpp"
#include "runtime/haptics/methods/contact_method.hpp"
#include "runtime/haptics/whole_tool/tool_spheres.hpp"

namespace palpate::haptics {

/// Contact found in every tick: a tool is a sphere, a row of spheres where it has a shaft, or what spheres an
/// instrument with a surface of its own is filled with. Each holds a god-object on the rigid bodies and one
/// on all bodies as if they were rigid, and a lone one goes along where tissue pushes it; where only the tip
/// touches, and only rigid bodies, the force is that of the virtual coupling, stiffness * (proxy - device),
/// otherwise tools and tissue are brought to rest together (ContactEquilibrium). A shaft turns as the device
/// says, and the torque that would turn it back is not rendered; a tool that turns by itself, Case::tool,
/// hangs on a spring of torsion besides, which has its rest among the others, and gives torque. A tool that
/// jumped does not feel a body that it is in until it has been clear of it; one that turns by itself feels
/// nothing until all of it has been clear of every body.
class ContinuousContact final : public ContactMethod {
  public:
    /// `bodies` must outlive this. Of the case it reads what is held, friction, and which bodies are
    /// hyperelastic. Throws InvalidInput if what is to turn by itself is a ball.
    ContinuousContact(const Case& patient_case, const ContactBodies& bodies, std::size_t tool_count);
    ~ContinuousContact() override;

    void reset() noexcept override;
    void tick(std::span<const ContactPose> poses, const VirtualCoupling& coupling,
              std::span<TickResult> results, std::span<Eigen::Vector3d> forces) noexcept override;
    Detects detects() const noexcept override { return large_.any() ? Detects::forces : Detects::nothing; }
    void detect() noexcept override;
    void keep_forces() override;
    void detect_at(const std::array<double, 3>& device, std::int64_t tick) noexcept override;
    void add_beyond(std::size_t soft, std::span<const TickResult* const> results,
                    std::span<Eigen::Vector3f> displacements) override;
    std::span<const ToolSphere> spheres() const noexcept override { return spheres_; }

    static constexpr std::size_t most_spheres = 96;  ///< of an instrument
    static constexpr std::size_t most_of_rod = 49;

  private:
    // One of the tool's spheres.
    struct Part {
        GodObject on_rigid;
        GodObject
            on_all;  // as if nothing gave way: without friction, no equilibrium is farther from the device
        Eigen::Vector3d device = Eigen::Vector3d::Zero();      // where the coupling pulls it, mm
        Eigen::Vector3d wall_press = Eigen::Vector3d::Zero();  // of the tick before, of a tool that turns, N
    };
    struct Tool {
        std::vector<Part> parts;     // as spheres_
        std::size_t parts_felt = 0;  // in this tick: none without a trusted position, the tip alone
                                     // where a rod's direction is not known
        Eigen::Vector3d tip = Eigen::Vector3d::Zero();  // on its device, mm; and a frame that is turned as
        Eigen::Matrix3d orientation = Eigen::Matrix3d::Identity();  // it is there, its z along the shaft
        Eigen::Vector3d rested_at = Eigen::Vector3d::Zero();  // its tip, at the end of the tick before, mm
        bool held_beside_tip = false;                         // by a sphere that is not about its tip
        std::size_t measured_last = 0;                        // of the parts: how far from all bodies
        bool was_off_device = false;  // at the end of the tick before, where it turns by itself
        bool waits = false;           // to be clear of every body
        std::size_t stuck = 0;        // the part that was not
    };

    // A tool of one sphere, among rigid bodies.
    struct Along {
        WallFollower follower;
        bool goes_on = false;                          // from the tick before, where tissue pushed it
        Eigen::Vector3d to = Eigen::Vector3d::Zero();  // then, off its device, mm
        bool led_elsewhere = false;                    // by the last solution, than where its walls hold it
    };

    // That a sphere would meet between its rest on rigid bodies and where the solution has it: how far its
    // device and that are beyond it, mm.
    struct MetWall {
        std::size_t tool = 0, part = 0;
        GodObject::Touch touch;
        double gap = 0, beyond = 0;
    };
    static constexpr std::size_t most_met = 8;  // that are added at once

    void place(std::size_t tool, const ContactPose& pose, TickResult& result) noexcept;
    bool is_clear(Tool& tool) const noexcept;
    void forget(std::size_t tool) noexcept;
    // By rigid bodies, by more than its tip; or was somewhere from where others may be in its way.
    static bool is_held(const Tool& tool) noexcept { return tool.held_beside_tip || tool.was_off_device; }
    Eigen::Vector3d aim_of(const Tool& tool, const Part& part) const noexcept;
    void settle(std::size_t tool, const Eigen::Vector3d& force, const TickResult& result) noexcept;
    void follow(std::size_t tool, TickResult& result) noexcept;
    void note_clearances(Tool& tool) noexcept;
    void write_neighbours(std::span<TickResult> results) const noexcept;
    void depth_in_tissue(const Tool& tool, TickResult& result) const noexcept;
    Eigen::Vector3d force_of(std::size_t tool, TickResult& result) noexcept;

    // In continuous_forces.cpp.
    Contact rigid_contact(const GodObject::Touch& touch, const Eigen::Vector3d& normal,
                          double gap) const noexcept;
    Eigen::Vector3d rigid_force(const GodObject& tip, const Eigen::Vector3d& device,
                                TickResult& result) const noexcept;
    bool within_reach(std::size_t tool, const Eigen::Vector3d& force) const noexcept;
    bool is_wall(const Contact& contact) const noexcept {
        return contact.part >= 0 && contact.body < static_cast<std::int32_t>(bodies_.rigid_count());
    }
    Eigen::Vector3d friction_of(std::size_t tool, std::size_t part, const TickResult& result) const noexcept;
    bool kept_by_tissue(const Part& part) const noexcept;
    void tell_turn(std::size_t tool, const ContactPose& pose, TickResult& result) const noexcept;
    Eigen::Vector3d wall_friction(std::size_t tool, const Eigen::Vector3d& force,
                                  TickResult& result) noexcept;

    // In continuous_walls.cpp.
    bool goes_along() const noexcept { return !along_.empty(); }
    Eigen::Vector3d off_of(std::size_t tool) const noexcept {
        return (equilibrium_.press(tool) + equilibrium_.drag(tool)) / coupling_;
    }
    void begin_walls(std::size_t tool, TickResult& result) noexcept;
    void add_walls_along(std::size_t tool, TickResult& result) noexcept;
    bool find_other_walls(std::span<TickResult> results, int round) noexcept;
    void hold_by_other_walls(std::span<TickResult> results, int round) noexcept;
    Eigen::Vector3d behind_walls(std::size_t tool, const TickResult& result) const noexcept;
    bool leads_elsewhere(std::size_t tool, const TickResult& result, bool renews) noexcept;
    void say_led_elsewhere(std::span<TickResult> results) const noexcept;
    void keep_along(std::size_t tool, const TickResult& result) noexcept;
    bool meets_others_on_the_way() noexcept;
    void hold_by_met(std::span<TickResult> results) noexcept;
    bool hold_by(std::size_t tool, std::size_t part, const Contact& wall, TickResult& result) noexcept;
    void drop_idle_walls(std::span<TickResult> results) noexcept;

    const ContactBodies& bodies_;
    const std::vector<ToolSphere> spheres_;  // of every tool; a rod's tip first
    const bool is_instrument_;
    Friction friction_;
    double coupling_ = 0;  // of this tick, N/mm
    double torsion_;       // rad / (N mm) that a tool turns by against its device; 0: it does not
    std::vector<const collision::CollisionSurface*> rigid_surfaces_, all_surfaces_;
    std::vector<Tool> tools_;
    std::vector<Along> along_;  // by tool; none where these are of several spheres
    ContactEquilibrium equilibrium_;
    LargeDeformation large_;
    FixedList<ContactEquilibrium::Sphere, most_spheres> placed_;  // of the tool that is being placed
    FixedList<MetWall, most_met> met_;                            // the farthest gone through first
};

/// A ContinuousContact, as the table of contact methods makes it.
std::unique_ptr<ContactMethod> make_continuous(const Case& patient_case, const ContactBodies& bodies,
                                               std::size_t tool_count);

}  // namespace palpate::haptics
