// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <string>

#include "runtime/devices/hand.hpp"
#include "runtime/realtime/device.hpp"

namespace palpate::devices {

/// A device in a guided hand of infinite stiffness: it is where GuidedHand is, whatever the force.
class GuidedDevice final : public realtime::Device {
  public:
    /// `start`, `max_speed`: see GuidedHand. `shaft`: see DeviceState; of a tool that is turned, along z.
    GuidedDevice(const HandTarget& start, DeviceLimits limits, double max_speed = GuidedHand::usual_speed,
                 const std::array<double, 3>& shaft = {0, 0, 0})
        : hand_(start, max_speed), shaft_(shaft), limits_(limits) {}

    /// As GuidedHand's.
    void set_target(const HandTarget& target) noexcept { hand_.set_target(target); }

    std::string name() const override { return "simulated, " + hand_.name(); }
    DeviceLimits limits() const override { return limits_; }
    realtime::DeviceState read(double time) noexcept override;
    void write(const realtime::Wrench&) noexcept override {}

  private:
    GuidedHand hand_;
    std::array<double, 3> shaft_;
    DeviceLimits limits_;
};

}  // namespace palpate::devices
