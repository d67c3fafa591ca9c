// SPDX-License-Identifier: Apache-2.0
#include "runtime/devices/guided_device.hpp"

#include "formats/model/arrays.hpp"
#include "runtime/devices/set_orientation.hpp"

namespace palpate::devices {

realtime::DeviceState GuidedDevice::read(double time) noexcept {
    const HandWish wish = hand_.at(time);
    realtime::DeviceState state;
    state.time = time;
    state.position = array_of(wish.position);
    state.shaft = shaft_;
    set_orientation(state, wish.orientation);
    return state;
}

}  // namespace palpate::devices
