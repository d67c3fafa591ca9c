// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "formats/model/body.hpp"
#include "formats/records/tool_settings.hpp"
#include "runtime/haptics/contact/contact_bodies.hpp"
#include "runtime/haptics/methods/contact_method.hpp"
#include "runtime/haptics/whole_tool/tool_rest.hpp"
#include "runtime/haptics/whole_tool/tool_touch.hpp"

namespace palpate::haptics {

/// A whole tool with position and orientation against rigid bodies, which has no mass: in every tick it rests
/// where a spring to its device, along all six degrees of freedom, and what it touches balance (Wan, McNeely
/// 2003). Force and torque are the spring's. How touches are found and what a touch is, is the methods'
/// that derive from this. Without friction; deformable bodies are not felt.
///
/// A device without orientation holds the tool along its shaft, or upright. A tool that was placed or found
/// inside a body feels nothing until all of it has been clear.
class WholeToolContact : public ContactMethod {
  public:
    /// Of a tool's touches, so many of the deepest become contacts of a result.
    static constexpr std::size_t most_told = 8;

    ~WholeToolContact() override;
    void reset() noexcept override;
    void tick(std::span<const ContactPose> poses, const VirtualCoupling& coupling,
              std::span<TickResult> results, std::span<Eigen::Vector3d> forces) noexcept override;

  protected:
    /// `bodies` must outlive this.
    WholeToolContact(const ContactBodies& bodies, const ToolSettings& settings, std::size_t tool_count);

    /// Forgets where a tool was.
    virtual void forget(std::size_t tool) noexcept = 0;
    /// A tool is free: nothing of where it was may change what comes, so that a replay may begin there.
    virtual void set_free(std::size_t /*tool*/) noexcept {}
    /// Whether a tool at a pose is clear of every body.
    virtual bool is_clear(std::size_t tool, const ToolPose& pose) noexcept = 0;
    /// Moves a tool from its pose towards where it rests; what it touches there is in touches() after.
    virtual ToolRest bring_to_rest(std::size_t tool, const TurningCoupling& coupling,
                                   ToolPose& pose) noexcept = 0;
    /// What is close to a tool where it was brought to rest, and how much of it presses.
    virtual std::span<const ToolTouch> touches(std::size_t tool) noexcept = 0;
    /// How deep a touch's point is in its body, mm: zero for methods that let none in.
    virtual double depth_of(const ToolTouch& touch) const noexcept = 0;
    /// Within which distance of a touch's point its body's surface is, mm.
    virtual double surface_within(const ToolTouch& touch) const noexcept = 0;

    /// Whether a point (p_P, mm) is outside of every rigid body.
    bool is_outside_all(const Eigen::Vector3d& p) const noexcept;

    const ContactBodies& bodies_;
    const ToolSettings settings_;

  private:
    struct Tool {
        ToolPose pose;
        bool placed = false;              // in an earlier tick
        bool waits = false;               // until it is clear of every body
        std::vector<std::int32_t> hints;  // of each body's surface
    };

    bool stays_clear(std::size_t tool, const ContactPose& at, const ToolPose& device,
                     TickResult& result) noexcept;
    void tell(std::size_t tool, const ToolPose& device, TickResult& result) noexcept;
    Contact contact_of(Tool& tool, const ToolTouch& touch) const noexcept;
    double depth_at(const Tool& tool, const ToolPose& device, const ToolTouch& touch) const noexcept;

    std::vector<Tool> tools_;
};

/// The surface of a case's tool: its own, or that of a ball of the settings' radius with their shaft, of 24
/// corners around. Throws InvalidInput if it has more than `most_triangles`.
TriangleMesh tool_surface(const Case& patient_case, std::size_t most_triangles);

/// The settings of a case's tool, or the usual ones. Throws InvalidInput if the case has no rigid body.
ToolSettings whole_tool_settings(const Case& patient_case, const std::string& method);

}  // namespace palpate::haptics
