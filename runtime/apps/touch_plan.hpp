// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>

#include "formats/model/body.hpp"
#include "runtime/apps/touch_options.hpp"
#include "runtime/devices/device_kind.hpp"
#include "runtime/devices/hand_path.hpp"
#include "runtime/haptics/haptic_model.hpp"
#include "runtime/session/device_list.hpp"
#include "runtime/session/jaws/grasp_place.hpp"
#include "runtime/session/touch_target.hpp"
#include "tools/cli/command.hpp"

namespace palpate::apps {

/// What the hand does, and where if that was chosen here.
struct TouchPlan {
    std::optional<devices::HandPath> path;  ///< none where a person's hand moves
    std::optional<session::TouchTarget> target;
    std::optional<session::GraspPlace> grasp;  ///< of a forceps
    double seconds = 0;
};

/// Throws UsageError for an option that means nothing beside the others: what a script is told to a person's
/// hand, or a recording's length without a recording.
void refuse_idle_options(const cli::Command& command, const TouchOptions& options);

/// Throws UsageError for options that contradict each other, or the device that options.device names.
void refuse_contradictions(const TouchOptions& options, const session::DeviceChoice& device);

/// How many tools there are.
std::size_t tools_of(const TouchOptions& options, const session::DeviceChoice& device);

/// Chooses place and path. Throws UsageError or InvalidInput where there is none.
TouchPlan plan_of(const TouchOptions& options, const devices::DeviceKind& device, const Case& patient_case,
                  const haptics::HapticModel& model);

/// What is asked of devices that follow the plan.
devices::DeviceRequest request_of(const TouchOptions& options, const devices::DeviceKind& device,
                                  const TouchPlan& plan, const haptics::HapticModel& model);

}  // namespace palpate::apps
