// SPDX-License-Identifier: Apache-2.0
#include "runtime/devices/simulated_device.hpp"

#include <algorithm>
#include <utility>

#include "formats/model/errors.hpp"
#include "runtime/devices/set_orientation.hpp"

namespace palpate::devices {

SimulatedDevice::SimulatedDevice(HandPath path, DeviceLimits limits, const std::array<double, 3>& shaft)
    : path_(std::move(path)), limits_(limits), shaft_(shaft) {
    if (!std::ranges::all_of(path_.keys(), &HandPath::Key::holds))
        throw UsageError({"the hand's path", "it lets go of a device without mass", "a hand that holds on",
                          "simulate the device with --device"});
}

realtime::DeviceState SimulatedDevice::read(double time) noexcept {
    const Eigen::Vector3d p = path_.at(time);
    realtime::DeviceState state;
    state.time = time;
    state.position = {p[0], p[1], p[2]};
    state.shaft = shaft_;
    set_orientation(state, path_.orientation_at(time));
    state.jaw_angle = path_.jaw_angle_at(time);
    return state;
}

}  // namespace palpate::devices
