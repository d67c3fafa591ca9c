// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "runtime/devices/device_model.hpp"
#include "runtime/devices/hand_path.hpp"
#include "runtime/realtime/device.hpp"

namespace palpate {

/// The hand that holds a simulated device: a spring and a damper towards where it wants to be. Both zero: no
/// hand.
struct HandImpedance {
    double stiffness = 0.3;  ///< N/mm
    double damping = 2e-3;   ///< N s/mm
};

/// A simulated device with dynamics, in a hand of finite impedance that follows a path: the closed loop.
/// Each axis obeys
///     m x'' = F - b x' + k_h (h - x) + b_h (h' - x') - f_c x' / |x'|
/// with the motors' force F as commanded delay_ticks writes ago, the hand's wish h(t) and Coulomb friction
/// f_c, which holds a tip at rest while everything else stays within f_c. F is held between ticks. Time goes
/// in steps of 1/16 ms, over which h moves uniformly and friction keeps its direction; the rest is solved
/// exactly. Same calls, same bits.
class DynamicDevice final : public Device {
  public:
    static constexpr double step_s = 1e-3 / 16;

    /// At rest at time 0 where the path begins. Throws InvalidInput if a figure of model or hand is not
    /// finite or negative, or the mass is zero; max_force may be infinite. `shaft`: see DeviceState; it does
    /// not turn.
    DynamicDevice(DeviceModel model, HandImpedance hand, HandPath path,
                  const std::array<double, 3>& shaft = {0, 0, 0});

    std::string name() const override { return "simulated " + model_.name + ", scripted hand"; }
    DeviceLimits limits() const override { return {model_.max_force, model_.max_stiffness, model_.damping}; }
    /// Moves the tip to `time` (to the nearest step; never back) and reads its encoders: each coordinate
    /// rounded down to their resolution. Cost: 16 steps of 30 ns per ms of time gone.
    DeviceState read(double time) noexcept override;
    /// `force` must be finite (unchecked); its direction stays where the motors saturate.
    void write(const std::array<double, 3>& force) noexcept override;

    /// Where the tip is and how it moves, beyond what encoders tell: mm, mm/s.
    const Eigen::Vector3d& position() const noexcept { return position_; }
    const Eigen::Vector3d& velocity() const noexcept { return velocity_; }

  private:
    void step(const Eigen::Vector3d& hand_end) noexcept;

    DeviceModel model_;
    HandImpedance hand_;
    HandPath path_;
    std::array<double, 3> shaft_;
    Eigen::Matrix<double, 2, 3>
        transition_;                         // (position, velocity) after a step from (position, velocity, F)
    std::vector<Eigen::Vector3d> commands_;  // a ring of the last delay_ticks + 1
    std::size_t next_command_ = 0;
    std::int64_t steps_ = 0;
    Eigen::Vector3d hand_position_, position_;
    Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero(), force_ = Eigen::Vector3d::Zero();
};

}  // namespace palpate
