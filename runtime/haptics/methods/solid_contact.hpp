// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>
#include <vector>

#include "runtime/collision/features/surface_features.hpp"
#include "runtime/haptics/methods/whole_tool_contact.hpp"
#include "runtime/haptics/solid/solid_equilibrium.hpp"

namespace palpate::haptics {

/// A whole tool whose triangles touch those of rigid bodies and never meet them: every tick moves it from
/// where it was towards its device as far as its way is clear, around what it touches, at any speed, and
/// lets it rest there (bring_to_rest()). No sampling, no voxels: vertices, edges and faces as they are.
///
/// A tool without a body of its own (Case::tool) is a ball of the settings' radius with their shaft, of 24
/// corners around.
class SolidContact final : public WholeToolContact {
  public:
    /// Most triangles that a tool may have, and have after its edges are split.
    static constexpr std::size_t most_triangles = 50'000;
    /// To which length a tool's edges are split, mm, so that little lies near a triangle.
    static constexpr double longest_edge = 5;

    /// `bodies` and `patient_case`'s must outlive this. Throws InvalidInput if there is no rigid body, or the
    /// tool has too many triangles.
    SolidContact(const Case& patient_case, const ContactBodies& bodies, std::size_t tool_count);
    ~SolidContact() override;

  private:
    void forget(std::size_t tool) noexcept override;
    bool is_clear(std::size_t tool, const ToolPose& pose) noexcept override;
    ToolRest bring_to_rest(std::size_t tool, const TurningCoupling& coupling,
                           ToolPose& pose) noexcept override;
    std::span<const ToolTouch> touches(std::size_t tool) noexcept override;
    double depth_of(const ToolTouch& touch) const noexcept override;
    double surface_within(const ToolTouch& touch) const noexcept override;

    collision::SurfaceFeatures surface_;                // the tool's
    std::vector<collision::SurfaceFeatures> features_;  // of the rigid bodies' slots
    std::vector<SolidBody> solids_;
    std::vector<SolidWatch> watches_;  // of each tool
};

/// A SolidContact, as the table of contact methods makes it.
std::unique_ptr<ContactMethod> make_solid(const Case& patient_case, const ContactBodies& bodies,
                                          std::size_t tool_count);

}  // namespace palpate::haptics
