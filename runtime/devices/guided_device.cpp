// SPDX-License-Identifier: Apache-2.0
#include "runtime/devices/guided_device.hpp"

#include <Eigen/Core>
#include <algorithm>

namespace palpate {

GuidedDevice::GuidedDevice(const std::array<double, 3>& start, DeviceLimits limits, double max_speed,
                           const std::array<double, 3>& shaft)
    : target_(start), position_(start), shaft_(shaft), limits_(limits), max_speed_(max_speed) {}

DeviceState GuidedDevice::read(double time) noexcept {
    Eigen::Map<Eigen::Vector3d> position(position_.data());
    const Eigen::Vector3d way = Eigen::Map<const Eigen::Vector3d>(target_.read().data()) - position;
    const double longest = max_speed_ * std::max(0.0, time - last_time_);
    const double length = way.norm();
    position += length > longest ? Eigen::Vector3d(way * (longest / length)) : way;
    last_time_ = time;
    DeviceState state;
    state.time = time;
    state.position = position_;
    state.shaft = shaft_;
    return state;
}

}  // namespace palpate
