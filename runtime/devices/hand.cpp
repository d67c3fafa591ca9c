// SPDX-License-Identifier: Apache-2.0
#include "runtime/devices/hand.hpp"

#include <algorithm>

#include "formats/model/arrays.hpp"
#include "runtime/devices/set_orientation.hpp"

namespace palpate::devices {

HandWish GuidedHand::at(double time) noexcept {
    const HandTarget& target = target_.read();
    const double seconds = std::max(0.0, time - last_time_);
    const Eigen::Vector3d way = vector_of(target.position) - position_;
    const double longest = max_speed_ * seconds;
    const double length = way.norm();
    position_ += length > longest ? Eigen::Vector3d(way * (longest / length)) : way;
    turn(quaternion_of(target.orientation), seconds);
    last_time_ = time;
    return {.position = position_, .orientation = orientation_};
}

void GuidedHand::turn(const Eigen::Quaterniond& target, double seconds) noexcept {
    if (!is_known(orientation_) || !is_known(target)) return;
    const double angle = orientation_.angularDistance(target), longest = turning_speed * seconds;
    orientation_ = angle > longest ? orientation_.slerp(longest / angle, target).normalized() : target;
}

}  // namespace palpate::devices
