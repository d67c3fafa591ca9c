// SPDX-License-Identifier: Apache-2.0
#include "runtime/doctor/checks/device_checks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace palpate::doctor {
namespace {

using namespace realtime;

constexpr const char* device_group = "device";

// Where a Phantom's driver puts the tip while all joint angles are zero, as without encoder data: the
// WorkspaceOffset of its configuration. Real encoders never give it to a hundredth of a millimetre.
bool at_zero_angles(const DeviceState& state) {
    constexpr std::array<double, 3> offset{0, -110, -35};  // mm
    constexpr double tolerance = 0.01;                     // mm
    for (std::size_t axis = 0; axis < 3; ++axis)
        if (!(std::abs(state.position[axis] - offset[axis]) <= tolerance)) return false;
    return true;
}

Finding calibration(Calibration calibration) {
    switch (calibration) {
        case Calibration::ok:
            break;
        case Calibration::needs_update:
            return {"calibration", device_group, Level::warning, "is to be brought up to date",
                    "# put the stylus into its inkwell for a second; Palpate does the rest when it starts"};
        case Calibration::needs_manual_input:
            return {"calibration", device_group, Level::problem, "the device does not know where it is",
                    "# put the stylus into its inkwell (Touch) or the arm into its reset position (Desktop,\n"
                    "# Premium), then run 'palpate doctor' again"};
    }
    return {"calibration", device_group, Level::ok, "up to date", ""};
}

Finding pose(std::span<const DeviceState> states) {
    if (states.empty())
        return {"pose", device_group, Level::problem, "the device gave no position",
                "# unplug the device, plug it in again, and run 'palpate doctor' again"};
    const std::array<double, 3>& p = states.back().position;
    const std::string place = fmt::format("{:.1f}, {:.1f}, {:.1f} mm", p[0], p[1], p[2]);
    if (std::ranges::all_of(states, at_zero_angles))
        return {
            "pose", device_group, Level::problem, place + ": the driver gets no data from the encoders",
            "# unplug the device from USB and power, plug it in again into a port of the computer itself,\n"
            "# set it up again as yourself, and run 'palpate doctor' again:\n"
            "bin/Touch_Setup"};
    return {"pose", device_group, Level::ok, place, ""};
}

Finding faults(std::span<const DeviceState> states) {
    std::uint32_t seen = no_fault;
    for (const DeviceState& state : states) seen |= state.faults;
    Finding finding{"faults", device_group, Level::ok, fault_names(seen), ""};
    for (const FaultText& text : fault_texts())
        if ((seen & text.fault) != 0) {
            finding.level = Level::problem;
            finding.fix +=
                fmt::format("{}# {}: {}", finding.fix.empty() ? "" : "\n", text.cause, text.remedy);
        }
    return finding;
}

Finding limits(const DeviceLimits& limits) {
    if (!(limits.max_force > 0))
        return {"limits", device_group, Level::warning, "the device does not say how strong it is",
                "# keep 'max_force_n' in the case file's [haptics] to what its data sheet says"};
    std::string torque = ", no torque";
    if (limits.max_torque > 0) torque = fmt::format(", torque {:.0f} N mm", limits.max_torque);
    if (limits.max_continuous_torque > 0)
        torque += fmt::format(", for long {:.0f} N mm", limits.max_continuous_torque);
    return {"limits", device_group, Level::ok,
            fmt::format("{:.1f} N, for long {:.2f} N, stiffness {:.2f} N/mm, {:.0f} Hz", limits.max_force,
                        limits.max_continuous_force, limits.max_stiffness, limits.rate_hz) +
                torque,
            ""};
}

Finding workspace(const DeviceLimits& limits) {
    std::array<double, 3> size{};
    for (std::size_t axis = 0; axis < 3; ++axis)
        size[axis] = limits.workspace_high[axis] - limits.workspace_low[axis];
    if (std::ranges::any_of(size, [](double edge) { return !(edge > 0); }))
        return {"workspace", device_group, Level::warning, "the device does not say how far it reaches", ""};
    return {"workspace", device_group, Level::ok,
            fmt::format("{:.0f} x {:.0f} x {:.0f} mm", size[0], size[1], size[2]), ""};
}

}  // namespace

Findings device_findings(const OpenedDevice& device) {
    return {{"name", device_group, Level::ok, device.name, ""},
            calibration(device.calibration),
            pose(device.first_states),
            faults(device.first_states),
            limits(device.limits),
            workspace(device.limits)};
}

}  // namespace palpate::doctor
