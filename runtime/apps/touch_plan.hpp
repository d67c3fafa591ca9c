// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "formats/model/body.hpp"
#include "runtime/devices/device_kind.hpp"
#include "runtime/devices/hand_path.hpp"
#include "runtime/haptics/haptic_model.hpp"
#include "runtime/session/device_list.hpp"
#include "runtime/session/touch_target.hpp"
#include "tools/cli/command.hpp"

namespace palpate {

/// What the user asked of touch.
struct TouchOptions {
    std::filesystem::path asset, log, curve, record, replay;
    std::string script = "press", body, target, second, scheme{usual_contact_method}, device, shaft, stream;
    double seconds = 10, depth = 3, speed = 20, record_seconds = 300;
    std::uint64_t seed = 1;
    std::optional<std::size_t> column;
    bool seconds_given = false, virtual_clock = false;
};

/// What the hand does, and where if that was chosen here.
struct TouchPlan {
    std::optional<HandPath> path;  ///< none where a person's hand moves
    std::optional<TouchTarget> target;
    double seconds;
};

/// Throws UsageError for an option that means nothing beside the others: what a script is told to a person's
/// hand, or a recording's length without a recording.
void refuse_idle_options(const cli::Command& command, const TouchOptions& options);

/// Throws UsageError for options that contradict each other, or the device that options.device names.
void refuse_contradictions(const TouchOptions& options, const DeviceChoice& device);

/// How many tools there are.
std::size_t tools_of(const TouchOptions& options, const DeviceChoice& device);

/// Chooses place and path. Throws UsageError or InvalidInput where there is none.
TouchPlan plan_of(const TouchOptions& options, const DeviceKind& device, const Case& patient_case,
                  const HapticModel& model);

/// What is asked of devices that follow the plan.
DeviceRequest request_of(const TouchOptions& options, const DeviceKind& device, const TouchPlan& plan,
                         const HapticModel& model);

}  // namespace palpate
