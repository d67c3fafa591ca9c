// SPDX-License-Identifier: Apache-2.0
#include "runtime/apps/run_recorder.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "formats/asset/asset.hpp"
#include "formats/model/errors.hpp"

namespace palpate {
namespace {

static_assert(most_recorded_contacts == static_cast<std::int64_t>(max_contacts));

RecordedTick recorded(const TickResult& r) noexcept {
    return {.tick = r.tick,
            .tool = r.tool,
            .time = r.time,
            .device_position = r.device_position,
            .shaft = r.shaft,
            .buttons = r.buttons,
            .faults = static_cast<std::int32_t>(r.faults),
            .status = static_cast<std::int32_t>(r.status),
            .tool_position = r.tool_position,
            .force = r.force,
            .depth = r.depth,
            .residual = r.residual,
            .body = r.body,
            .contact_count = r.contact_count,
            .detected_tick = r.detected_tick,
            .tick_ns = r.tick_ns,
            .wake_latency_ns = r.wake_latency_ns,
            .overruns = r.overruns};
}

RecordedContact recorded(const Contact& c) noexcept {
    return {.body = c.body,
            .part = c.part,
            .triangle = c.triangle,
            .vertices = c.vertices,
            .weights = c.weights,
            .normal = c.normal,
            .gap = c.gap,
            .force = c.force,
            .series_compliance = c.series_compliance,
            .friction = c.friction};
}

}  // namespace

RecordingHead recording_head(const std::filesystem::path& asset, const Case& patient_case,
                             const HapticModel& model, std::span<Device* const> devices,
                             const std::string& clock, const std::string& version) {
    RecordingHead head{.palpate_version = version,
                       .case_name = patient_case.name,
                       .asset_digest = asset_digest(asset),
                       .scheme = std::string(contact_scheme_names[static_cast<std::size_t>(model.scheme())]),
                       .clock = clock,
                       .coupling_stiffness = model.coupling(),
                       .haptics = model.settings(),
                       .devices = {}};
    for (const Device* device : devices) {
        const DeviceLimits limits = device->limits();
        head.devices.push_back({.name = device->name(),
                                .max_force = limits.max_force,
                                .max_stiffness = limits.max_stiffness,
                                .damping = limits.damping,
                                .max_continuous_force = limits.max_continuous_force,
                                .rate_hz = limits.rate_hz,
                                .workspace_low = limits.workspace_low,
                                .workspace_high = limits.workspace_high});
    }
    return head;
}

DeviceLimits limits_of(const RecordedDevice& device) {
    return {.max_force = device.max_force,
            .max_stiffness = device.max_stiffness,
            .damping = device.damping,
            .max_continuous_force = device.max_continuous_force,
            .rate_hz = device.rate_hz,
            .workspace_low = device.workspace_low,
            .workspace_high = device.workspace_high};
}

DeviceState state_of(const RecordedTick& tick) {
    return {.time = tick.time,
            .position = tick.device_position,
            .shaft = tick.shaft,
            .buttons = static_cast<std::uint32_t>(tick.buttons),
            .faults = static_cast<std::uint32_t>(tick.faults)};
}

std::int64_t recording_rows(double seconds, std::size_t tools) {
    constexpr double least = 0.01, most = 1e6;  // s
    if (!(seconds >= least && seconds <= most))
        throw UsageError({"--record-seconds", std::to_string(seconds), "0.01 to 1000000", ""});
    return static_cast<std::int64_t>(std::ceil(1000 * seconds)) * static_cast<std::int64_t>(tools);
}

void RunRecorder::add(const TickResult& result) noexcept {
    std::array<RecordedContact, max_contacts> contacts;
    const std::span<const Contact> active = result.active_contacts();
    std::ranges::transform(active, contacts.begin(), [](const Contact& c) { return recorded(c); });
    writer_.add(recorded(result), std::span(contacts).first(active.size()));
    ++rows_;
}

void RunRecorder::set_lost(std::uint64_t results) noexcept {
    writer_.set_lost(static_cast<std::int64_t>(results));
}

}  // namespace palpate
