// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "formats/model/body.hpp"
#include "runtime/collision/field/distance_field.hpp"
#include "runtime/collision/points/point_shell.hpp"
#include "runtime/haptics/contact/contact_bodies.hpp"
#include "runtime/haptics/methods/contact_method.hpp"
#include "runtime/haptics/shell/shell_equilibrium.hpp"

namespace palpate::haptics {

/// A whole tool with position and orientation against rigid bodies: points on its surface against a distance
/// field of each body, after McNeely, Puterbaugh, Troy 1999, "Six degree-of-freedom haptic rendering using
/// voxel sampling". The tool has no mass and rests in every tick between its device and what its points are
/// inside of (bring_to_rest()); force and torque are those of a spring from device to tool along all six
/// degrees of freedom. Without friction; deformable bodies are not felt.
///
/// Where it is not as in 1999, and why: there a depth is to the plane through a voxel's centre across the
/// point's normal, which jumps from voxel to voxel; here it is the trilinear interpolant of exact distances
/// (Barbic, James 2008), so that the force is the gradient of an energy. There the tool has a mass and its
/// motion is integrated, with a coupling tuned to stay stable, and more than ten touching points are
/// averaged; here it is at rest (Wan, McNeely 2003), which needs neither.
///
/// A tool without a body of its own (Case::tool) is a ball of the settings' radius with their shaft. A device
/// without orientation holds it along its shaft, or upright. A tool that was placed or found inside a body
/// feels nothing until all of it has been clear.
class ShellContact final : public ContactMethod {
  public:
    /// Of a tool's touches, so many of the deepest become contacts of a result.
    static constexpr std::size_t most_told = 8;
    /// How far on either side of a surface distances are known at least, in voxels.
    static constexpr double band_voxels = 3;

    /// `bodies` must outlive this; the tool's settings make sense (unchecked). Throws InvalidInput if there
    /// is no rigid body, and as DistanceField.
    ShellContact(const Case& patient_case, const ContactBodies& bodies, std::size_t tool_count);
    ~ShellContact() override;

    void reset() noexcept override;
    void tick(std::span<const ContactPose> poses, double coupling, std::span<TickResult> results,
              std::span<Eigen::Vector3d> forces) noexcept override;

  private:
    struct Tool {
        ShellWatch watch;
        ToolPose pose;
        bool placed = false;              // in an earlier tick
        bool waits = false;               // until it is clear of every body
        std::vector<std::int32_t> hints;  // of each body's surface
    };

    bool stays_clear(Tool& tool, const ContactPose& at, const ToolPose& device, TickResult& result) noexcept;
    void tell(Tool& tool, const ToolPose& device, TickResult& result) const noexcept;
    Contact contact_of(Tool& tool, const ShellTouch& touch) const noexcept;
    double depth_at(const ToolPose& device, const ShellTouch& touch) const noexcept;

    const ContactBodies& bodies_;
    ToolSettings settings_;
    std::vector<collision::DistanceField> fields_;  // of the rigid bodies
    std::vector<collision::ShellPoint> points_;
    std::vector<Tool> tools_;
};

/// How far a step takes a point near a body at most, mm.
inline double longest_step(const ToolSettings& settings) noexcept {
    return 0.5 * settings.voxel;
}

/// A ShellContact, as the table of contact methods makes it.
std::unique_ptr<ContactMethod> make_shell(const Case& patient_case, const ContactBodies& bodies,
                                          std::size_t tool_count);

}  // namespace palpate::haptics
