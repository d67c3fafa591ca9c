// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <string>

#include "runtime/devices/hand_path.hpp"
#include "runtime/realtime/device.hpp"

namespace palpate::devices {

/// A device in a hand of infinite stiffness: it is where its path says, whatever the force.
class SimulatedDevice final : public realtime::Device {
  public:
    /// `shaft`: see DeviceState. Throws UsageError if the path lets go: without a mass there is no telling
    /// where the device would go.
    SimulatedDevice(HandPath path, DeviceLimits limits, const std::array<double, 3>& shaft = {0, 0, 0});

    std::string name() const override { return "simulated, scripted hand"; }
    DeviceLimits limits() const override { return limits_; }
    realtime::DeviceState read(double time) noexcept override;
    void write(const realtime::Wrench&) noexcept override {}

  private:
    HandPath path_;
    DeviceLimits limits_;
    std::array<double, 3> shaft_;
};

}  // namespace palpate::devices
