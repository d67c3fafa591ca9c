// SPDX-License-Identifier: Apache-2.0
#include "runtime/devices/guided_device.hpp"

namespace palpate::devices {

realtime::DeviceState GuidedDevice::read(double time) noexcept {
    const Eigen::Vector3d p = hand_.at(time).position;
    realtime::DeviceState state;
    state.time = time;
    state.position = {p[0], p[1], p[2]};
    state.shaft = shaft_;
    return state;
}

}  // namespace palpate::devices
