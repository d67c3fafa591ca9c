// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <memory>

#include "runtime/devices/device_model.hpp"
#include "runtime/devices/hand.hpp"
#include "runtime/realtime/device.hpp"

namespace palpate {

/// Which way is up for a device whose tool is to touch no surface known beforehand: towards the patient's
/// front, -y of LPS.
inline const Eigen::Vector3d anterior{0, -1, 0};

/// Where a device of `model` stands, X_PD in mm, so that the middle of its workspace is at `start` (p_P, mm)
/// and its y axis points along `up` (unit), as mount_upright().
Eigen::Isometry3d placed_at(const DeviceModel& model, const Eigen::Vector3d& start,
                            const Eigen::Vector3d& up);

/// A simulated device of `model` that stands at `X_PD`, seen from the patient. `hand`, of usual impedance,
/// moves in the device's frame D; `shaft`, see DeviceState, is in P. Throws as DynamicDevice.
std::unique_ptr<Device> simulate(const DeviceModel& model, std::shared_ptr<Hand> hand,
                                 const Eigen::Isometry3d& X_PD, const std::array<double, 3>& shaft);

/// The same with a hand that follows `path` (frame P), at whose beginning the device is placed.
std::unique_ptr<Device> simulate(const DeviceModel& model, const HandPath& path, const Eigen::Vector3d& up,
                                 const std::array<double, 3>& shaft);

}  // namespace palpate
