// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "formats/model/body.hpp"
#include "formats/records/jaw_settings.hpp"
#include "formats/records/status_counts.hpp"
#include "runtime/haptics/haptic_model.hpp"
#include "runtime/session/device_list.hpp"
#include "tools/cli/command.hpp"

namespace palpate::apps {

/// What a user holds instead of the ball or rod that a device turns: --instrument and how that is felt.
struct ToolOption {
    std::string tool;  ///< empty, "rod", "forceps" or a file
    ToolSettings settings{};
    JawSettings jaws{};

    /// Whether it has a surface of its own.
    bool has_surface() const { return !tool.empty() && tool != "rod" && !has_jaws(); }
    bool has_jaws() const { return tool == "forceps"; }
};

/// Adds --instrument and its settings to a command.
void declare(cli::Command& command, ToolOption& option);

/// Throws UsageError if a setting is given without its --instrument, or `scheme` does not feel such a tool.
void check(const cli::Command& command, const ToolOption& option, const std::string& scheme);

/// Throws UsageError for what does not go with a forceps, one device's, or only with one: made to measure
/// `script`s, several devices, a second tool.
void check_hand(const ToolOption& option, const std::string& script, const session::DeviceChoice& device,
                const std::string& second);

/// What is held and turns by itself; nothing without --instrument, or of a forceps. Throws as read_stl().
std::optional<ToolBody> tool_body(const ToolOption& option);

/// The jaws of a forceps; nothing of anything else.
std::optional<JawSettings> jaws_of(const ToolOption& option);

/// Warns of what of a case is not felt with a scheme.
void tell_unfelt(const Case& patient_case, const std::string& scheme);

/// Says where a tool's torque is shown and recorded, and a device does not let it be felt. `device`: what it
/// calls itself.
void tell_torque(const haptics::HapticModel& model, const std::string& device);

/// Warns of each region of a case whose change of the force the device loses in its joints, and says how deep
/// to press instead; nothing of a device that is not known. `device`: what it calls itself.
void tell_too_weak(const Case& patient_case, const std::string& device);

/// Warns where a tool was inside a body from the run's first tick to its last.
void tell_misfit(const StatusCounts& statuses, std::int64_t ticks);

}  // namespace palpate::apps
