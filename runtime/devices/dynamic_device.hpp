// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "runtime/devices/device_model.hpp"
#include "runtime/devices/hand.hpp"
#include "runtime/realtime/device.hpp"

namespace palpate::devices {

/// The hand that holds a simulated device: a spring and a damper towards where it wants to be. Both zero: no
/// hand.
struct HandImpedance {
    double stiffness = 0.3;  ///< N/mm
    double damping = 2e-3;   ///< N s/mm
};

/// A simulated device with dynamics, in a hand of finite impedance: the closed loop. Each axis obeys
///     m x'' = F - b x' + k_h (h - x) + b_h (h' - x') - f_c x' / |x'|
/// with the motors' force F as commanded delay_ticks writes ago, the hand's wish h(t) and Coulomb friction
/// f_c, which holds a tip at rest while everything else stays within f_c. F is held between ticks. A hand
/// that has let go leaves k_h = b_h = 0; it takes hold where the tip is, and draws it to its wish at
/// take_up_speed beyond its own motion, so that nothing jumps. Time goes in steps of 1/16 ms, over which h
/// moves uniformly and friction keeps its direction; the rest is solved exactly. The motors' temperature
/// obeys T' = (F² / F_c² - T) / tau, exactly, with the force F_c that they bear for ever: T = 1 is their
/// limit. From there until they have cooled to cool_enough the state carries motors_warm; the motors
/// themselves go on. The tool turns as the hand wishes: the wrist's own dynamics, and torque, are not
/// simulated. Same calls, same bits.
class DynamicDevice final : public realtime::Device {
  public:
    static constexpr double step_s = 1e-3 / 16;
    static constexpr double take_up_speed = 50;  ///< mm/s; a choice
    static constexpr double cool_enough = 0.9;   ///< of the motors' limit; a choice

    /// At rest and cool at time 0 where the hand is. Throws InvalidInput if a figure of model or impedance is
    /// not finite or negative, or the mass or the thermal time is zero; max_force may be infinite. `hand`, in
    /// frame D, must not be null (asserted). `shaft`: see DeviceState; it does not turn.
    DynamicDevice(DeviceModel model, HandImpedance impedance, std::shared_ptr<Hand> hand,
                  const std::array<double, 3>& shaft = {0, 0, 0});
    /// The same in a hand that follows a path.
    DynamicDevice(DeviceModel model, HandImpedance impedance, HandPath path,
                  const std::array<double, 3>& shaft = {0, 0, 0});

    std::string name() const override { return "simulated " + model_.name + ", " + hand_->name(); }
    DeviceLimits limits() const override { return limits_of(model_); }
    /// Moves the tip to `time` (to the nearest step; never back) and reads its encoders: each coordinate
    /// rounded down to their resolution. Cost: 16 steps of 20 to 50 ns, by the length of the path, per ms of
    /// time gone.
    realtime::DeviceState read(double time) noexcept override;
    /// `force` must be finite (asserted); its direction stays where the motors saturate.
    void write(const std::array<double, 3>& force) noexcept override;

    /// Where the tip is and how it moves, beyond what encoders tell: mm, mm/s.
    const Eigen::Vector3d& position() const noexcept { return position_; }
    const Eigen::Vector3d& velocity() const noexcept { return velocity_; }
    /// Of the motors: 0 cool, 1 at their limit, and beyond. From the thread that reads.
    double motor_temperature() const noexcept { return temperature_; }

  private:
    // (position, velocity) after a step from (position, velocity, F).
    using Transition = Eigen::Matrix<double, 2, 3>;
    Eigen::Vector3d grip(const HandWish& wish) noexcept;
    void step(const HandWish& wish) noexcept;
    void warm_up() noexcept;

    DeviceModel model_;
    HandImpedance impedance_;
    std::shared_ptr<Hand> hand_;
    std::array<double, 3> shaft_;
    Transition held_transition_, free_transition_;
    std::vector<Eigen::Vector3d> commands_;  // a ring of the last delay_ticks + 1
    std::size_t next_command_ = 0;
    std::int64_t steps_ = 0;
    bool held_;
    Eigen::Vector3d hand_position_, position_;
    Eigen::Vector3d slack_ = Eigen::Vector3d::Zero();  // from the wish to where the hand took hold
    Eigen::Quaterniond orientation_{0, 0, 0, 0};
    double jaw_angle_ = -1;
    Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero(), force_ = Eigen::Vector3d::Zero();
    double heating_ = 0;      // F² / F_c²
    double temperature_ = 0;  // T
    double cooling_ = 0;      // what a step leaves of a difference of temperature
    bool warm_ = false;
};

}  // namespace palpate::devices
