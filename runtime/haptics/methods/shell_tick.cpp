// SPDX-License-Identifier: Apache-2.0
// How points find what a whole tool touches.
#include "runtime/haptics/methods/shell_contact.hpp"

namespace palpate::haptics {

void ShellContact::forget(std::size_t tool) noexcept {
    watches_[tool].reset();
}

bool ShellContact::is_clear(std::size_t tool, const ToolPose& pose) noexcept {
    watches_[tool].look(pose);
    return !watches_[tool].touches();
}

ToolRest ShellContact::bring_to_rest(std::size_t tool, const TurningCoupling& coupling,
                                     ToolPose& pose) noexcept {
    const ToolRest rest = haptics::bring_to_rest(watches_[tool], coupling, settings_.contact_stiffness,
                                                 longest_step(settings_), pose);
    watches_[tool].press(settings_.contact_stiffness);
    return rest;
}

std::span<const ToolTouch> ShellContact::touches(std::size_t tool) noexcept {
    return watches_[tool].close();
}

double ShellContact::depth_of(const ToolTouch& touch) const noexcept {
    return -touch.distance;
}

double ShellContact::surface_within(const ToolTouch& touch) const noexcept {
    return -touch.distance + 2 * fields_[static_cast<std::size_t>(touch.body)].error();
}

}  // namespace palpate::haptics
