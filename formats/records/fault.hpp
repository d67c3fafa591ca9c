// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <string>

namespace palpate {

/// Why the force is taken away; flags add up.
enum Fault : std::uint32_t {
    no_fault = 0,
    invalid_position = 1U << 0,    ///< the device said something that is not a finite number
    device_lost = 1U << 1,         ///< the device no longer answers
    not_calibrated = 1U << 2,      ///< the device does not know where it is
    pose_frozen = 1U << 3,         ///< the device's encoders give no data
    motors_warm = 1U << 4,         ///< the device's motors are at their thermal limit
    device_refused = 1U << 5,      ///< the device cut the force by its own limit of force, impulse or speed
    invalid_force = 1U << 6,       ///< the tick computed something that is not a finite number
    tick_late = 1U << 7,           ///< the servo stood still for longer than it may
    collision_stale = 1U << 8,     ///< a published scheme's collision loop has stopped
    visual_stopped = 1U << 9,      ///< the visual loop has stopped
    asset_removed = 1U << 10,      ///< the asset's file is gone or another one
    servo_stopping = 1U << 11,     ///< the run ends
    implausible_speed = 1U << 12,  ///< the device's position jumped farther than a hand goes
};

/// Faults after which a device's position is not to be used.
inline constexpr std::uint32_t distrusted_position =
    invalid_position | device_lost | not_calibrated | pose_frozen | implausible_speed;

/// What is said of a fault.
struct FaultText {
    Fault fault;
    const char* name;    ///< "motors_warm"
    const char* cause;   ///< "the device's motors are too warm"
    const char* remedy;  ///< "let the device rest"
};

/// Every fault, in the order of the flags.
std::span<const FaultText> fault_texts();

/// Names the flags of `faults`, separated by '+'; "none" for none.
std::string fault_names(std::uint32_t faults);

}  // namespace palpate
