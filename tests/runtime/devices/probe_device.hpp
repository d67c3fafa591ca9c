// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <string>

#include "runtime/realtime/device.hpp"

namespace palpate {

/// A device that is where it was told to be and keeps what it was told to render, frame D.
class ProbeDevice final : public realtime::Device {
  public:
    std::string name() const override { return "probe"; }
    DeviceLimits limits() const override {
        return {.max_force = 3,
                .max_stiffness = 0.5,
                .damping = 1e-3,
                .max_continuous_force = 1,
                .rate_hz = 1000,
                .workspace_low = {-80, -60, -35},
                .workspace_high = {80, 60, 45},
                .max_torque = 100,
                .max_torsional_stiffness = 500};
    }
    realtime::DeviceState read(double time) noexcept override {
        realtime::DeviceState told = state;
        told.time = time;
        return told;
    }
    void write(const realtime::Wrench& wanted) noexcept override { wrench = wanted; }

    realtime::DeviceState state;
    realtime::Wrench wrench;
};

}  // namespace palpate
