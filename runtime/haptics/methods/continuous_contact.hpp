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
#include "runtime/haptics/contact/contact_solver.hpp"
#include "runtime/haptics/contact/god_object.hpp"
#include "runtime/haptics/methods/contact_method.hpp"

namespace palpate::haptics {

/// Contact found in every tick: a tool is a sphere, or a row of spheres where it has a shaft. Each holds a
/// god-object on the rigid bodies and one on each deformable body; where only the tip touches, and only rigid
/// bodies, the force is that of the virtual coupling, stiffness * (proxy - device), otherwise all contact
/// points are solved together (ContactSolver). The shaft turns as the device says; the torque that would turn
/// it back is not rendered. A tool that jumped does not feel a body that it is in until it has been clear of
/// it.
class ContinuousContact final : public ContactMethod {
  public:
    /// `bodies` must outlive this. Of the settings it reads radius, shaft and friction.
    ContinuousContact(const ContactBodies& bodies, const HapticSettings& settings, std::size_t tool_count);
    ~ContinuousContact() override;

    void reset() noexcept override;
    void tick(std::span<const ContactPose> poses, double coupling, std::span<TickResult> results,
              std::span<Eigen::Vector3d> forces) noexcept override;

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
        std::vector<Part> parts;             // the tip first
        std::vector<Contact> last_contacts;  // of the tick before: room for max_contacts, the first are valid
        std::size_t last_count = 0;
        std::size_t parts_felt = 0;  // in this tick: none without a trusted position, the tip alone
                                     // without a shaft's direction
    };

    static void place(Tool& tool, const ContactPose& pose) noexcept;
    static void forget(Tool& tool) noexcept;
    void follow(std::size_t tool, TickResult& result) noexcept;
    void follow_soft(std::size_t tool, std::size_t part, std::size_t soft, TickResult& result) noexcept;
    Eigen::Vector3d moved_by_others(std::size_t tool, std::size_t part, std::size_t soft,
                                    const Eigen::Vector3d& place) const noexcept;
    Eigen::Vector3d force_of(Tool& tool, double residual, TickResult& result) noexcept;

    // In continuous_forces.cpp.
    Contact rigid_contact(const GodObject::Touch& touch, const Eigen::Vector3d& normal,
                          double gap) const noexcept;
    Eigen::Vector3d rigid_force(const GodObject& tip, const Eigen::Vector3d& device,
                                TickResult& result) const noexcept;
    bool hold_off_rigid(std::span<TickResult> results) noexcept;
    void add_rigid_contacts(std::size_t tool, TickResult& result) noexcept;
    bool within_reach(const Tool& tool, const TickResult& result) const noexcept;
    Eigen::Vector3d solved_force(Tool& tool, const TickResult& result) const noexcept;
    Eigen::Vector3d friction_of(const Part& part) const noexcept;
    Eigen::Vector3d friction_of(SoftTouch& touch, const DeformableContact& body) const noexcept;

    const ContactBodies& bodies_;
    Friction friction_;
    double coupling_ = 0;  // of this tick, N/mm
    std::vector<const collision::CollisionSurface*> rigid_surfaces_, all_surfaces_;
    std::vector<Tool> tools_;
    ContactSolver solver_;
};

/// A ContinuousContact, as the table of contact methods makes it.
std::unique_ptr<ContactMethod> make_continuous(const Case& patient_case, const ContactBodies& bodies,
                                               std::size_t tool_count);

}  // namespace palpate::haptics
