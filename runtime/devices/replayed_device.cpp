// SPDX-License-Identifier: Apache-2.0
#include "runtime/devices/replayed_device.hpp"

#include <algorithm>
#include <cmath>

#include "formats/model/errors.hpp"

namespace palpate::devices {

using namespace realtime;

ReplayedDevice::ReplayedDevice(std::vector<DeviceState> states, DeviceLimits limits)
    : states_(std::move(states)), limits_(limits) {
    if (states_.empty()) throw InvalidInput({"replayed device", "no state", "one or more", ""});
}

DeviceState ReplayedDevice::read(double time) noexcept {
    const double last = static_cast<double>(states_.size() - 1);
    const double tick = std::clamp(std::round(1000 * time), 0.0, last);
    DeviceState state = states_[static_cast<std::size_t>(tick)];
    state.time = time;
    return state;
}

}  // namespace palpate::devices
