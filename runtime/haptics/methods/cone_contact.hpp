// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <vector>

#include "runtime/collision/cones/normal_cone_tree.hpp"
#include "runtime/collision/features/surface_features.hpp"
#include "runtime/haptics/cones/cone_watch.hpp"
#include "runtime/haptics/methods/whole_tool_contact.hpp"

namespace palpate::haptics {

/// A whole tool pushed off by every local minimum of its distance from rigid bodies that is shorter than a
/// reach, before surfaces meet, after Johnson, Willemsen, Cohen 2005, "Six degree-of-freedom haptic rendering
/// using spatialized normal cone search". Each is a spring of the tool's contact_stiffness from the reach on;
/// the tool rests between them and its device (rest_of_penalties()).
///
/// Where it is not as in 2005, and why: there the tool has a mass and its motion is integrated, and what goes
/// through is lost; here it is at rest (Wan, McNeely 2003) and moves no farther at a time than its least
/// distance; where that is hardly any it moves by 0.005 mm if that meets nothing, so that it goes through
/// nothing. There new minima are searched for in a loop of their own and followed by local descent in the
/// haptic one; here all are found in every tick. As there, a minimum that merges with another takes its force
/// along at once.
///
/// A tool without a body of its own (Case::tool) is a ball of the settings' radius with their shaft, of 24
/// corners around.
class ConeContact final : public WholeToolContact {
  public:
    /// Most triangles that a tool may have.
    static constexpr std::size_t most_triangles = 50'000;

    /// `bodies` must outlive this. Throws InvalidInput if there is no rigid body, or the tool has too many
    /// triangles.
    ConeContact(const Case& patient_case, const ContactBodies& bodies, std::size_t tool_count);
    ~ConeContact() override;

  private:
    void forget(std::size_t tool) noexcept override;
    bool is_clear(std::size_t tool, const ToolPose& pose) noexcept override;
    ToolRest bring_to_rest(std::size_t tool, const TurningCoupling& coupling,
                           ToolPose& pose) noexcept override;
    std::span<const ToolTouch> touches(std::size_t tool) noexcept override;
    double depth_of(const ToolTouch& touch) const noexcept override;
    double surface_within(const ToolTouch& touch) const noexcept override;

    double reach_;  // mm
    collision::SurfaceFeatures tool_;
    collision::NormalConeTree tool_tree_;
    std::vector<collision::SurfaceFeatures> features_;  // of the rigid bodies
    std::vector<collision::NormalConeTree> trees_;
    std::vector<ConeWatch> watches_;  // of each tool
};

/// A ConeContact, as the table of contact methods makes it.
std::unique_ptr<ContactMethod> make_cones(const Case& patient_case, const ContactBodies& bodies,
                                          std::size_t tool_count);

}  // namespace palpate::haptics
