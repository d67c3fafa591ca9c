// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>

#include "formats/model/body.hpp"
#include "runtime/session/jaws/grasp_place.hpp"
#include "runtime/session/replay.hpp"
#include "runtime/session/run_record.hpp"
#include "runtime/session/touch_target.hpp"

namespace palpate::apps {

/// Where a script touches.
nlohmann::ordered_json target_json(const session::TouchTarget& target, const haptics::HapticModel& model);

/// Where a forceps takes hold.
nlohmann::ordered_json grasp_json(const session::GraspPlace& place, const haptics::HapticModel& model);

/// What a run left of one tool: largest force and force step (N), penetration (mm), statuses, and its peak:
/// the tick of the largest force, with all that is needed to compute it again from the stiffness matrix.
nlohmann::ordered_json tool_json(const session::RunRecord& record, const Case& patient_case,
                                 const haptics::HapticModel& model);

nlohmann::ordered_json replay_json(const session::ReplayOutcome& outcome);

}  // namespace palpate::apps
