// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>

#include "runtime/doctor/finding.hpp"
#include "runtime/realtime/device.hpp"

namespace palpate::doctor {

/// What an opened device said of itself.
struct OpenedDevice {
    std::string name;
    realtime::Calibration calibration = realtime::Calibration::ok;
    DeviceLimits limits;
    std::span<const realtime::DeviceState> first_states{};  ///< of its first ticks, in the device's own frame
};

/// Checks a device once it has been opened: calibration, faults, whether it moves off the pose that its
/// driver reports without encoder data, and whether it knows its limits and its workspace.
Findings device_findings(const OpenedDevice& device);

}  // namespace palpate::doctor
