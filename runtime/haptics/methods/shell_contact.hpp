// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "formats/model/body.hpp"
#include "runtime/collision/field/distance_field.hpp"
#include "runtime/collision/points/point_shell.hpp"
#include "runtime/haptics/contact/contact_bodies.hpp"
#include "runtime/haptics/methods/whole_tool_contact.hpp"
#include "runtime/haptics/shell/shell_equilibrium.hpp"

namespace palpate::haptics {

/// A whole tool as points on its surface against a distance field of each rigid body, after McNeely,
/// Puterbaugh, Troy 1999, "Six degree-of-freedom haptic rendering using voxel sampling". It rests between its
/// device and what its points are inside of (bring_to_rest()).
///
/// Where it is not as in 1999, and why: there a depth is to the plane through a voxel's centre across the
/// point's normal, which jumps from voxel to voxel; here it is the trilinear interpolant of exact distances
/// (Barbic, James 2008), so that the force is the gradient of an energy. There the tool has a mass and its
/// motion is integrated, with a coupling tuned to stay stable, and more than ten touching points are
/// averaged; here it is at rest (Wan, McNeely 2003), which needs neither.
///
/// A tool without a body of its own (Case::tool) is a ball of the settings' radius with their shaft.
class ShellContact final : public WholeToolContact {
  public:
    /// How far on either side of a surface distances are known at least, in voxels.
    static constexpr double band_voxels = 3;

    /// `bodies` must outlive this; the tool's settings make sense (unchecked). Throws InvalidInput if there
    /// is no rigid body, and as DistanceField.
    ShellContact(const Case& patient_case, const ContactBodies& bodies, std::size_t tool_count);
    ~ShellContact() override;

  private:
    void forget(std::size_t tool) noexcept override;
    bool is_clear(std::size_t tool, const ToolPose& pose) noexcept override;
    ToolRest bring_to_rest(std::size_t tool, const TurningCoupling& coupling,
                           ToolPose& pose) noexcept override;
    std::span<const ToolTouch> touches(std::size_t tool) noexcept override;
    double depth_of(const ToolTouch& touch) const noexcept override;
    double surface_within(const ToolTouch& touch) const noexcept override;

    std::vector<collision::DistanceField> fields_;  // of the rigid bodies
    std::vector<collision::ShellPoint> points_;
    std::vector<ShellWatch> watches_;  // of each tool
};

/// How far a step takes a point near a body at most, mm.
inline double longest_step(const ToolSettings& settings) noexcept {
    return 0.5 * settings.voxel;
}

/// A ShellContact, as the table of contact methods makes it.
std::unique_ptr<ContactMethod> make_shell(const Case& patient_case, const ContactBodies& bodies,
                                          std::size_t tool_count);

}  // namespace palpate::haptics
