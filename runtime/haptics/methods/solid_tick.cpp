// SPDX-License-Identifier: Apache-2.0
// How triangles find what a whole tool touches.
#include <algorithm>

#include "runtime/haptics/methods/solid_contact.hpp"

namespace palpate::haptics {

using Eigen::Vector3d;

void SolidContact::forget(std::size_t tool) noexcept {
    watches_[tool].reset();
}

bool SolidContact::is_clear(std::size_t tool, const ToolPose& pose) noexcept {
    SolidWatch& watch = watches_[tool];
    watch.look(pose);
    if (watch.meets()) return false;
    // No surface cuts another: one point of the tool tells whether it is in a body.
    const Vector3d p = pose.position + pose.orientation * surface_.vertex(0);
    return std::ranges::all_of(solids_, [&](const SolidBody& body) { return body.surface->is_outside(p); });
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
