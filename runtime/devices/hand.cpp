// SPDX-License-Identifier: Apache-2.0
#include "runtime/devices/hand.hpp"

#include <algorithm>

namespace palpate::devices {

HandWish GuidedHand::at(double time) noexcept {
    const Eigen::Vector3d way = Eigen::Map<const Eigen::Vector3d>(target_.read().data()) - position_;
    const double longest = max_speed_ * std::max(0.0, time - last_time_);
    const double length = way.norm();
    position_ += length > longest ? Eigen::Vector3d(way * (longest / length)) : way;
    last_time_ = time;
    return {position_};
}

}  // namespace palpate::devices
