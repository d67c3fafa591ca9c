// SPDX-License-Identifier: Apache-2.0
#include "formats/records/fault.hpp"

#include <array>

namespace palpate {

std::span<const FaultText> fault_texts() {
    static constexpr std::array<FaultText, 13> texts{{
        {invalid_position, "invalid_position", "the device gave a position that is not a number",
         "check its cables, then 'palpate doctor'"},
        {device_lost, "device_lost", "the device no longer answers",
         "check power and cable; the force comes back when it answers"},
        {not_calibrated, "not_calibrated", "the device is not calibrated",
         "put the stylus into its inkwell, or run 'palpate doctor'"},
        {pose_frozen, "pose_frozen", "the device's encoders give no data",
         "unplug it, plug it in again, and run 'palpate doctor'"},
        {motors_warm, "motors_warm", "the device's motors are too warm", "let them cool down"},
        {device_refused, "device_refused", "the device cut the force by a limit of its own",
         "move more slowly, or lower max_force_n in the case"},
        {invalid_force, "invalid_force", "a force was not a number", "run 'palpate verify' on the asset"},
        {tick_late, "tick_late", "the servo stood still",
         "close other programs, or permit real-time priority: 'palpate doctor' says how"},
        {collision_stale, "collision_stale", "the collision loop has stopped",
         "close other programs, or use the scheme 'continuous', which needs none"},
        {visual_stopped, "visual_stopped", "the window has stopped drawing",
         "close other programs, or make the window smaller"},
        {asset_removed, "asset_removed", "the asset's file was removed or changed",
         "put the file back, or start again with the new one"},
        {servo_stopping, "servo_stopping", "the run ends", ""},
        {implausible_speed, "implausible_speed", "the device's position jumped, faster than 5 m/s",
         "check its cables, then 'palpate doctor'"},
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
