// SPDX-License-Identifier: Apache-2.0
// How a whole tool comes to rest between its device and gaps that push it off.
#include "runtime/haptics/methods/gap_contact.hpp"
#include "runtime/haptics/whole_tool/penalty_equilibrium.hpp"

namespace palpate::haptics {

namespace {

// A look costs some tens of microseconds, and what is left of a way the next tick goes on with.
constexpr PenaltyEffort effort{.rounds = 4, .halvings = 2, .looks = 7, .crosses_kinks = true};

}  // namespace

void GapContact::forget(std::size_t tool) noexcept {
    watches_[tool]->reset();
}

void GapContact::set_free(std::size_t tool) noexcept {
    watches_[tool]->set_free();
}

bool GapContact::is_clear(std::size_t tool, const ToolPose& pose) noexcept {
    if (watches_[tool]->meets(pose)) return false;
    // No surface cuts another: one point of the tool tells whether it is in a body.
    return is_outside_all(pose.position + pose.orientation * tool_.vertex(0));
}

ToolRest GapContact::bring_to_rest(std::size_t tool, const TurningCoupling& coupling,
                                   ToolPose& pose) noexcept {
    GapWatch& watch = *watches_[tool];
    const ToolRest rest = rest_of_penalties(
        watch, coupling, settings_.contact_stiffness, [&] { return watch.longest_step(); }, effort, pose);
    watch.press(settings_.contact_stiffness);
    return rest;
}

std::span<const ToolTouch> GapContact::touches(std::size_t tool) noexcept {
    return watches_[tool]->close();
}

double GapContact::depth_of(const ToolTouch& /*touch*/) const noexcept {
    return 0;
}

double GapContact::surface_within(const ToolTouch& /*touch*/) const noexcept {
    return reach_;
}

}  // namespace palpate::haptics
