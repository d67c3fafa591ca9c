// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "runtime/realtime/device.hpp"

namespace palpate::devices {

/// A device that repeats what another one said, one state per millisecond, whatever the force.
class ReplayedDevice final : public realtime::Device {
  public:
    /// `states`: of the ticks at 0, 1, 2 ... ms; their times are not looked at. Throws InvalidInput if there
    /// is none.
    ReplayedDevice(std::vector<realtime::DeviceState> states, DeviceLimits limits);

    std::string name() const override { return "replayed"; }
    DeviceLimits limits() const override { return limits_; }
    /// The state of the tick nearest to `time` (s); the first before all, the last after all.
    realtime::DeviceState read(double time) noexcept override;
    void write(const realtime::Wrench&) noexcept override {}

  private:
    std::vector<realtime::DeviceState> states_;
    DeviceLimits limits_;
};

}  // namespace palpate::devices
