// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "runtime/devices/device_model.hpp"
#include "runtime/devices/dynamics/hand_impedance.hpp"
#include "runtime/devices/dynamics/held_motion.hpp"
#include "runtime/devices/dynamics/motors.hpp"
#include "runtime/devices/dynamics/wrist.hpp"
#include "runtime/devices/hand.hpp"
#include "runtime/realtime/device.hpp"

namespace palpate::devices {

/// A simulated device with dynamics, in a hand of finite impedance: the closed loop. Each axis obeys
///     m x'' = F - b x' + k_h (h - x) + b_h (h' - x') - f_c x' / |x'|
/// with the motors' force F as commanded delay_ticks writes ago, the hand's wish h(t) and Coulomb friction
/// f_c, which holds a tip at rest while everything else stays within f_c. F is held between ticks. A hand
/// that has let go leaves k_h = b_h = 0; it takes hold where the tip is, and draws it to its wish at
/// take_up_speed beyond its own motion, so that nothing jumps. Time goes in steps of 1/16 ms, over which h
/// moves uniformly and friction keeps its direction; the rest is solved exactly. While Motors are warm the
/// state carries motors_warm; they go on. The tool of a device that renders torque turns as a Wrist has it,
/// if it is known at the start how it is turned; that of another turns as the hand wishes. Same calls, same
/// bits.
class DynamicDevice final : public realtime::Device {
  public:
    static constexpr double step_s = 1e-3 / 16;
    static constexpr double take_up_speed = 50;  ///< mm/s; a choice

    /// At rest and cool at time 0 where the hand is. Throws InvalidInput if a figure of model or impedance is
    /// not finite or negative, or the mass, the thermal time, or the inertia of what renders torque is zero;
    /// max_force may be infinite. `hand`, in frame D, must not be null (asserted). `shaft`: see DeviceState;
    /// where the hand does not say how it wishes the tool turned, along this.
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
    /// `wrench` must be finite (asserted); force and torque keep their directions where the motors saturate.
    void write(const realtime::Wrench& wrench) noexcept override;

    /// Where the tip is and how it moves, beyond what encoders tell: mm, mm/s.
    const Eigen::Vector3d& position() const noexcept { return position_; }
    const Eigen::Vector3d& velocity() const noexcept { return velocity_; }
    /// Of the motors that push: 0 cool, 1 at their limit, and beyond. From the thread that reads.
    double motor_temperature() const noexcept { return motors_.temperature(); }
    /// How its tool turns; null where it renders no torque or nobody says how it is turned.
    const Wrist* wrist() const noexcept { return wrist_ ? &*wrist_ : nullptr; }

  private:
    // What the motors do, N and N mm.
    struct Command {
        Eigen::Vector3d force{0, 0, 0}, torque{0, 0, 0};
    };
    Eigen::Vector3d grip(const HandWish& wish) noexcept;
    void step(const HandWish& wish) noexcept;
    void turn(const HandWish& wish) noexcept;

    DeviceModel model_;
    HandImpedance impedance_;
    std::shared_ptr<Hand> hand_;
    std::array<double, 3> shaft_;
    HeldMotion held_motion_, free_motion_;
    std::optional<Wrist> wrist_;
    Motors motors_, gimbal_motors_;
    std::vector<Command> commands_;  // a ring of the last delay_ticks + 1
    std::size_t next_command_ = 0;
    std::int64_t steps_ = 0;
    bool held_;
    Eigen::Vector3d hand_position_, position_;
    Eigen::Vector3d slack_ = Eigen::Vector3d::Zero();  // from the wish to where the hand took hold
    Eigen::Quaterniond orientation_{0, 0, 0, 0};
    double jaw_angle_ = -1;
    Eigen::Vector3d velocity_ = Eigen::Vector3d::Zero();
    Command command_;
};

}  // namespace palpate::devices
