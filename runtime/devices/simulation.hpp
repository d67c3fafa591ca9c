// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <vector>

#include "formats/model/body.hpp"
#include "runtime/devices/device_kind.hpp"
#include "runtime/devices/device_model.hpp"

namespace palpate::devices {

/// A tool whose hand follows `path` (frame P), at whose beginning the device is placed with its y axis along
/// `up` (unit), as upright(). `shaft`: see DeviceState, frame P.
HeldTool scripted_tool(HandPath path, const Eigen::Vector3d& up, const std::array<double, 3>& shaft);

/// What a case asks of a device that states nothing of itself.
DeviceLimits limits_asked_by(const HapticSettings& settings);

/// A hand of infinite stiffness: it is where script, mouse or keys put it, whatever the force.
DeviceKind stiff_hand_kind();

/// Each of device_models(), in a hand of usual impedance, standing where its tool's place says. Opening
/// throws as DynamicDevice.
std::vector<DeviceKind> simulated_kinds();

}  // namespace palpate::devices
