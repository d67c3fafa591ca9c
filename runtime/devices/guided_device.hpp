// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <string>

#include "runtime/realtime/device.hpp"
#include "runtime/realtime/triple_buffer.hpp"

namespace palpate {

/// A simulated device that another thread guides, from mouse or keyboard: it moves towards its target at no
/// more than a given speed, so that sweeps stay as fast as a hand's.
class GuidedDevice final : public Device {
  public:
    /// `start`: first position and target, p_P, mm. `max_speed`: mm/s. `shaft`: see DeviceState.
    GuidedDevice(const std::array<double, 3>& start, DeviceLimits limits, double max_speed = 200,
                 const std::array<double, 3>& shaft = {0, 0, 0});

    /// Sets where to go (p_P, mm). Wait-free; from one thread, while the loop runs or not.
    void set_target(const std::array<double, 3>& position) noexcept { target_.write(position); }

    std::string name() const override { return "simulated, guided by mouse and keyboard"; }
    DeviceLimits limits() const override { return limits_; }
    DeviceState read(double time) noexcept override;
    void write(const std::array<double, 3>&) noexcept override {}

  private:
    TripleBuffer<std::array<double, 3>> target_;
    std::array<double, 3> position_, shaft_;
    double last_time_ = 0;
    DeviceLimits limits_;
    double max_speed_;
};

}  // namespace palpate
