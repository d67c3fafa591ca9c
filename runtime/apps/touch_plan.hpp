// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "formats/model/body.hpp"
#include "runtime/apps/physical_devices.hpp"
#include "runtime/apps/touch_target.hpp"
#include "runtime/devices/hand_path.hpp"
#include "runtime/haptics/haptic_model.hpp"
#include "tools/cli/command.hpp"

namespace palpate {

/// What the user asked of touch.
struct TouchOptions {
    std::filesystem::path asset, log, curve, record, replay;
    std::string script = "press", body, target, second, scheme = "continuous", device, shaft, stream;
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

/// The devices of a run, one for each tool.
struct HeldDevices {
    std::unique_ptr<PhysicalDevices> physical;
    std::vector<std::unique_ptr<Device>> simulated;
    std::vector<Device*> devices;
    Servo* servo = nullptr;  ///< null: the loop's own
};

/// Throws UsageError for an option that means nothing beside the others: what a script is told to a person's
/// hand, or a recording's length without a recording.
void refuse_idle_options(const cli::Command& command, const TouchOptions& options);

/// Throws UsageError for options that contradict each other. `physical`: what options.device names, if that
/// is not simulated.
void refuse_contradictions(const TouchOptions& options, const std::optional<PhysicalDevice>& physical);

/// Chooses place and path. Throws UsageError or InvalidInput where there is none.
TouchPlan plan_of(const TouchOptions& options, bool physical, const Case& patient_case,
                  const HapticModel& model);

/// Opens or makes the devices that follow the plan. Throws as PhysicalDevices.
HeldDevices hold(const TouchOptions& options, const std::optional<PhysicalDevice>& physical,
                 const TouchPlan& plan, const HapticModel& model);

}  // namespace palpate
