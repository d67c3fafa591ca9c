// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>

#include "formats/recording/recording.hpp"
#include "formats/records/tick_result.hpp"
#include "runtime/haptics/haptic_model.hpp"

namespace palpate::session {

/// A force or torque that a replay did not give again.
struct ForceDifference {
    std::int64_t tick = 0;
    std::int32_t tool = 0;
    std::array<double, 3> recorded{0, 0, 0};         ///< N
    std::array<double, 3> replayed{0, 0, 0};         ///< N
    std::array<double, 3> recorded_torque{0, 0, 0};  ///< N mm
    std::array<double, 3> replayed_torque{0, 0, 0};  ///< N mm
};

/// How a replay went.
struct ReplayOutcome {
    std::int64_t ticks = 0;               ///< replayed and compared
    std::int64_t different_ticks = 0;     ///< where a tool's force or torque was not the same, bit for bit
    std::int64_t missing_ticks = 0;       ///< of the run, up to its last: overwritten or lost
    std::int64_t skipped_ticks = 0;       ///< recorded, but before a tick from which a replay can start
    std::optional<std::int64_t> started;  ///< the first tick that was replayed
    std::optional<ForceDifference> first_difference;
    double largest_difference = 0;         ///< of a force, N
    double largest_torque_difference = 0;  ///< N mm
};

/// Throws InvalidInput naming both if the recording in `file` is of another asset than the one in `asset`.
void check_asset(const recording::Recording& recording, const std::filesystem::path& file,
                 const std::filesystem::path& asset);

/// The case that a recording in `file` is of, read from `asset`, with the tool that was held. Throws as
/// check_asset() and read_asset().
Case recorded_case(const recording::Recording& recording, const std::filesystem::path& file,
                   const std::filesystem::path& asset, std::span<const std::string> trusted_keys = {});

/// A model as the recorded run had it, fresh. `patient_case`: recorded_case(). Throws InvalidInput naming
/// `file` if it couples differently.
std::unique_ptr<haptics::HapticModel> model_of(const recording::Recording& recording,
                                               const std::filesystem::path& file, const Case& patient_case);

/// Throws InvalidInput naming `file` if the recording keeps one tick of many alone.
void require_all_ticks(const recording::Recording& recording, const std::filesystem::path& file);

/// Feeds what the recorded devices said, and every fault of the run, to a fresh model and compares the
/// forces and torques; a method that needs detection detects what it detected in the run. `sink` gets each
/// tool's result of each tick, with the run's own timing. Where ticks are missing, the model is reset and
/// taken up again at the third tick in a row that is free: no contact, no force, no torque, no fault and none
/// of its after-effects; a method that needs detection needs one in it besides. What went before such a tick
/// has no influence on the forces after it; where tissue creeps, that takes HapticModel::memory_ticks() more
/// of them. A recording that keeps one tick of many has no tick from which to go on: require_all_ticks().
ReplayOutcome replay(const recording::Recording& recording, haptics::HapticModel& model,
                     const std::function<void(const TickResult&)>& sink);

}  // namespace palpate::session
