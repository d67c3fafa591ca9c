// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "runtime/collision/features/surface_features.hpp"
#include "runtime/haptics/methods/whole_tool_contact.hpp"
#include "runtime/haptics/whole_tool/gap_watch.hpp"

namespace palpate::haptics {

/// A whole tool pushed off by places where it is nearer to rigid bodies than a reach, before surfaces meet.
/// Each is a spring of the tool's contact_stiffness from the reach on; the tool rests between them and its
/// device (rest_of_penalties()). A GapWatch finds them: what is published of that, and what differs here, is
/// where it is declared.
///
/// In each the tool has no mass: it is at rest (Wan, McNeely 2003) and moves no farther at a time than its
/// least distance; where that is hardly any it moves by 0.005 mm if that meets nothing, so that it goes
/// through nothing. A place that comes or goes takes its force along at once, as in Johnson, Willemsen, Cohen
/// 2005.
///
/// A tool without a body of its own (Case::tool) is a ball of the settings' radius with their shaft, of 24
/// corners around.
class GapContact : public WholeToolContact {
  public:
    /// Most triangles that a tool may have.
    static constexpr std::size_t most_triangles = 50'000;

    ~GapContact() override;

  protected:
    /// `bodies` must outlive this; `method` names it in errors. Leaves watches_ empty. Throws InvalidInput if
    /// there is no rigid body, or the tool has too many triangles.
    GapContact(const Case& patient_case, const ContactBodies& bodies, std::size_t tool_count,
               const std::string& method);

    double reach_;  // mm
    collision::SurfaceFeatures tool_;
    std::vector<collision::SurfaceFeatures> features_;  // of the rigid bodies
    std::vector<std::unique_ptr<GapWatch>> watches_;    // of each tool

  private:
    void forget(std::size_t tool) noexcept override;
    void set_free(std::size_t tool) noexcept override;
    bool is_clear(std::size_t tool, const ToolPose& pose) noexcept override;
    ToolRest bring_to_rest(std::size_t tool, const TurningCoupling& coupling,
                           ToolPose& pose) noexcept override;
    std::span<const ToolTouch> touches(std::size_t tool) noexcept override;
    double depth_of(const ToolTouch& touch) const noexcept override;
    double surface_within(const ToolTouch& touch) const noexcept override;
};

/// By every local minimum of the distance, as the table of contact methods makes it: ConeWatch.
std::unique_ptr<ContactMethod> make_cones(const Case& patient_case, const ContactBodies& bodies,
                                          std::size_t tool_count);
/// By the closest features of convex pieces, likewise: FeatureWatch.
std::unique_ptr<ContactMethod> make_features(const Case& patient_case, const ContactBodies& bodies,
                                             std::size_t tool_count);

}  // namespace palpate::haptics
