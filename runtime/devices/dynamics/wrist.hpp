// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>

#include "runtime/devices/device_model.hpp"
#include "runtime/devices/dynamics/hand_impedance.hpp"
#include "runtime/devices/dynamics/held_motion.hpp"

namespace palpate::devices {

/// How the tool of a simulated device with motors in its gimbal turns in a hand: about its tip, with the same
/// moment of inertia I about every axis,
///     I w' = T - b w + k_h phi + c_h (w_h - w),
/// where the rotation vector phi turns the tool to how the hand wishes it, which turns at w_h, and T is the
/// motors' torque. A hand that has let go leaves k_h = c_h = 0; it takes hold as the tool is turned then, and
/// turns it to its wish at take_up_rate beyond its own turning. Each step is that of the same equation in a
/// plane, exact where phi keeps its axis. Realtime-safe but for the constructor. Same calls, same bits.
class Wrist {
  public:
    static constexpr double take_up_rate = 1;  ///< rad/s; a choice

    /// At rest as `orientation` (R_DT) has it, in a hand if `held`. Unchecked: DynamicDevice checks the
    /// figures.
    Wrist(const DeviceModel& model, const HandImpedance& hand, const Eigen::Quaterniond& orientation,
          bool held, double step_s);

    /// A step of time goes by, at whose end the hand wishes the tool turned so, if it holds it. `torque`: of
    /// the motors meanwhile, N mm, frame D.
    void step(const Eigen::Quaterniond& wish, bool holds, const Eigen::Vector3d& torque) noexcept;

    /// R_DT.
    const Eigen::Quaterniond& orientation() const noexcept { return orientation_; }
    /// rad/s, frame D.
    const Eigen::Vector3d& angular_velocity() const noexcept { return angular_velocity_; }

  private:
    Eigen::Quaterniond grip(const Eigen::Quaterniond& wish, bool holds) noexcept;

    double step_s_, damping_;
    HeldMotion held_motion_, free_motion_;
    bool held_;
    Eigen::Quaterniond hand_orientation_, orientation_;
    Eigen::Vector3d slack_{0, 0, 0};  // from the wish to how the hand took hold, rad
    Eigen::Vector3d angular_velocity_{0, 0, 0};
};

}  // namespace palpate::devices
