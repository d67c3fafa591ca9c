// SPDX-License-Identifier: Apache-2.0
#include "formats/records/fault.hpp"

#include <array>

#include "formats/records/shown_text.hpp"

namespace palpate {

std::span<const FaultText> fault_texts() {
    static constexpr std::array<FaultText, 13> texts{{
        {invalid_position, "invalid_position", shown_text("the device gave a position that is not a number"),
         shown_text("check its cables, then 'palpate doctor'")},
        {device_lost, "device_lost", shown_text("the device no longer answers"),
         shown_text("check power and cable; the force comes back when it answers")},
        {not_calibrated, "not_calibrated", shown_text("the device is not calibrated"),
         shown_text("put the stylus into its inkwell, or run 'palpate doctor'")},
        {pose_frozen, "pose_frozen", shown_text("the device's encoders give no data"),
         shown_text("unplug it, plug it in again, and run 'palpate doctor'")},
        {motors_warm, "motors_warm", shown_text("the device's motors are too warm"),
         shown_text("let them cool down")},
        {device_refused, "device_refused", shown_text("the device cut the force by a limit of its own"),
         shown_text("move more slowly, or lower max_force_n in the case")},
        {invalid_force, "invalid_force", shown_text("a force was not a number"),
         shown_text("run 'palpate verify' on the asset")},
        {tick_late, "tick_late", shown_text("the servo stood still"),
         shown_text("close other programs, or permit real-time priority: 'palpate doctor' says how")},
        {collision_stale, "collision_stale", shown_text("the collision loop has stopped"),
         shown_text("close other programs, or use the scheme 'continuous', which needs none")},
        {visual_stopped, "visual_stopped", shown_text("the window has stopped drawing"),
         shown_text("close other programs, or make the window smaller")},
        {asset_removed, "asset_removed", shown_text("the asset's file was removed or changed"),
         shown_text("put the file back, or start again with the new one")},
        {servo_stopping, "servo_stopping", shown_text("the run ends"), ""},
        {implausible_speed, "implausible_speed",
         shown_text("the device's position jumped, faster than 5 m/s"),
         shown_text("check its cables, then 'palpate doctor'")},
    }};
    return texts;
}

std::string fault_names(std::uint32_t faults) {
    std::string names;
    for (const FaultText& text : fault_texts()) {
        if (!(faults & text.fault)) continue;
        if (!names.empty()) names += '+';
        names += text.name;
    }
    return names.empty() ? "none" : names;
}

}  // namespace palpate
