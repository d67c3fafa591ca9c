// SPDX-License-Identifier: Apache-2.0
// How triangles find what a whole tool touches.
#include "runtime/haptics/methods/solid_contact.hpp"

namespace palpate::haptics {

void SolidContact::forget(std::size_t tool) noexcept {
    watches_[tool].reset();
}

bool SolidContact::is_clear(std::size_t tool, const ToolPose& pose) noexcept {
    SolidWatch& watch = watches_[tool];
    watch.look(pose);
    if (watch.meets()) return false;
    // No surface cuts another: one point of the tool tells whether it is in a body.
    return is_outside_all(pose.position + pose.orientation * surface_.vertex(0));
}

ToolRest SolidContact::bring_to_rest(std::size_t tool, const TurningCoupling& coupling,
                                     ToolPose& pose) noexcept {
    return haptics::bring_to_rest(watches_[tool], coupling, pose);
}

std::span<const ToolTouch> SolidContact::touches(std::size_t tool) noexcept {
    return watches_[tool].touches();
}

double SolidContact::depth_of(const ToolTouch& /*touch*/) const noexcept {
    return 0;
}

double SolidContact::surface_within(const ToolTouch& /*touch*/) const noexcept {
    return SolidWatch::close;
}

}  // namespace palpate::haptics
