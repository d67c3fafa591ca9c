// SPDX-License-Identifier: Apache-2.0
#include "runtime/apps/touch_replay.hpp"

#include <array>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "formats/asset/asset.hpp"
#include "formats/model/errors.hpp"
#include "runtime/apps/tell_statuses.hpp"
#include "runtime/apps/touch_json.hpp"
#include "runtime/session/replay.hpp"

namespace palpate::apps {
namespace {

using namespace session;

std::string force_text(const std::array<double, 3>& f) {
    return fmt::format("({}, {}, {}) N", f[0], f[1], f[2]);
}

// A force, and a torque where there is one in run or replay.
std::string felt_text(const ForceDifference& first, const std::array<double, 3>& force,
                      const std::array<double, 3>& torque) {
    constexpr std::array<double, 3> none{0, 0, 0};
    if (first.recorded_torque == none && first.replayed_torque == none) return force_text(force);
    return fmt::format("{} and ({}, {}, {}) N mm", force_text(force), torque[0], torque[1], torque[2]);
}

}  // namespace

nlohmann::ordered_json replay_recording(const std::filesystem::path& file, const std::filesystem::path& asset,
                                        std::span<const std::string> trusted_keys, TouchOutputs& outputs,
                                        cli::Session& session) {
    const recording::Recording recording = recording::read_recording(file);
    require_all_ticks(recording, file);
    const Case patient_case = recorded_case(recording, file, asset, trusted_keys);
    const auto model = model_of(recording, file, patient_case);
    std::vector<RunRecord> records = outputs.records_of(*model);
    StatusCounts statuses;
    const ReplayOutcome outcome = replay(recording, *model, [&](const TickResult& result) {
        records[result.tool].add(result);
        statuses.add(result);
    });
    if (!outcome.started)
        throw InvalidInput({file.string(), "no tick from which a replay could start",
                            "the run's first tick, or three in a row without contact, force and fault",
                            "record for longer: --record-seconds"});
    outputs.commit(records.front(), patient_case.name + ": replay");
    if (recording.rows_unreadable > 0)
        spdlog::warn("{}: {} rows at the end never reached the disk", file.string(),
                     recording.rows_unreadable);
    if (*outcome.started > 0 || outcome.skipped_ticks > 0)
        spdlog::warn("{}: starts at tick {}; {} ticks are missing, {} were skipped for want of a free one",
                     file.string(), *outcome.started, outcome.missing_ticks, outcome.skipped_ticks);
    if (const auto& first = outcome.first_difference)
        session.shortfall = {
            file.string(),
            fmt::format("tick {} of tool {} gives {}; {} of {} ticks differ", first->tick, first->tool,
                        felt_text(*first, first->replayed, first->replayed_torque), outcome.different_ticks,
                        outcome.ticks),
            "the recorded " + felt_text(*first, first->recorded, first->recorded_torque),
            "the recording is of palpate " + recording.head.palpate_version + ", this is " + cli::version() +
                "; other versions, compilers and processors may round otherwise, and a file may have been "
                "changed"};
    tell_statuses(statuses);
    nlohmann::ordered_json result{{"case", patient_case.name},
                                  {"script", "replay"},
                                  {"scheme", recording.head.scheme},
                                  {"large_deformation", recording.head.hyperelastic},
                                  {"device", recording.head.devices.front().name},
                                  {"coupling_stiffness_n_per_mm", model->coupling()},
                                  {"clock", recording.head.clock},
                                  {"replay", replay_json(outcome)}};
    result.update(tool_json(records[0], patient_case, *model));
    if (records.size() > 1) result["second"] = tool_json(records[1], patient_case, *model);
    return result;
}

}  // namespace palpate::apps
