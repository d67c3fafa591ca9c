// SPDX-License-Identifier: Apache-2.0
#include "runtime/devices/simulated_device.hpp"

namespace palpate {

DeviceState SimulatedDevice::read(double time) noexcept {
    const Eigen::Vector3d p = path_.at(time);
    DeviceState state;
    state.time = time;
    state.position = {p[0], p[1], p[2]};
    state.shaft = shaft_;
    return state;
}

}  // namespace palpate
