// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <deque>
#include <string>

#include "runtime/devices/device_model.hpp"
#include "runtime/devices/hand_path.hpp"
#include "runtime/realtime/device.hpp"

namespace palpate {

/// The hand that holds a simulated device: a spring and a damper towards where it wants to be.
struct HandImpedance {
    double stiffness = 0.3;  ///< N/mm
    double damping = 2e-3;   ///< N s/mm
};

/// A simulated device with dynamics, in a hand of finite impedance that follows a path: the closed loop.
/// Between ticks the commanded force is held (zero-order hold) while mass, damping, friction and hand move
/// the tip.
class DynamicDevice final : public Device {
  public:
    DynamicDevice(DeviceModel model, HandImpedance hand, HandPath path);

    std::string name() const override;
    DeviceLimits limits() const override;
    /// Moves the tip from the last read to `time` and reads its encoders.
    DeviceState read(double time) noexcept override;
    void write(const std::array<double, 3>& force) noexcept override;

    /// Where the tip is and how it moves, beyond what encoders tell: mm, mm/s.
    const Eigen::Vector3d& position() const noexcept;
    const Eigen::Vector3d& velocity() const noexcept;
};

}  // namespace palpate
