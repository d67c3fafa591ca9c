// SPDX-License-Identifier: Apache-2.0
#include "runtime/session/run_recorder.hpp"

#include <cmath>

#include "formats/asset/asset.hpp"
#include "formats/model/errors.hpp"

namespace palpate::session {

using namespace realtime;
recording::RecordingHead recording_head(const std::filesystem::path& asset, const Case& patient_case,
                                        const haptics::HapticModel& model, std::span<Device* const> devices,
                                        const std::string& clock, const std::string& version) {
    recording::RecordingHead head{.palpate_version = version,
                                  .case_name = patient_case.name,
                                  .asset_digest = asset::asset_digest(asset),
                                  .scheme = std::string(model.method().name),
                                  .clock = clock,
                                  .coupling_stiffness = model.coupling(),
                                  .haptics = model.settings(),
                                  .devices = {},
                                  .tool = model.method().can.turns ? patient_case.tool : std::nullopt};
    if (model.method().can.deforms_far) head.hyperelastic = patient_case.hyperelastic;
    for (const Device* device : devices) head.devices.push_back({device->name(), device->limits()});
    return head;
}

DeviceState state_of(const Tick& tick) {
    return {.time = tick.time,
            .position = tick.device_position,
            .shaft = tick.shaft,
            .orientation = tick.orientation,
            .buttons = tick.buttons,
            .faults = tick.faults};
}

std::int64_t recording_rows(double seconds, std::size_t tools) {
    constexpr double least = 0.01, most = 1e6;  // s
    if (!(seconds >= least && seconds <= most))
        throw UsageError({"--record-seconds", std::to_string(seconds), "0.01 to 1000000", ""});
    return static_cast<std::int64_t>(std::ceil(1000 * seconds)) * static_cast<std::int64_t>(tools);
}

void RunRecorder::add(const TickResult& result) noexcept {
    writer_.add(result, result.active_contacts());
    ++rows_;
}

void RunRecorder::set_lost(std::uint64_t results) noexcept {
    writer_.set_lost(static_cast<std::int64_t>(results));
}

}  // namespace palpate::session
