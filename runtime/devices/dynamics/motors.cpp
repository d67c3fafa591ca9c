// SPDX-License-Identifier: Apache-2.0
#include "runtime/devices/dynamics/motors.hpp"

#include <cmath>

namespace palpate::devices {

Motors::Motors(double lasting, double thermal_time_s, double step_s)
    : lasting_(lasting), cooling_(std::exp(-step_s / thermal_time_s)) {}

void Motors::push(double amount) noexcept {
    heating_ = lasting_ > 0 ? amount * amount / (lasting_ * lasting_) : 0;
}

void Motors::warm_up() noexcept {
    temperature_ = heating_ + cooling_ * (temperature_ - heating_);
    if (temperature_ >= 1) warm_ = true;
    if (temperature_ <= cool_enough) warm_ = false;
}

}  // namespace palpate::devices
