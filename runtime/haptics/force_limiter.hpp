// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cstdint>

#include "formats/model/body.hpp"

namespace palpate::haptics {

/// Keeps the commanded force within what device and hand may bear, and takes it away where something is
/// wrong. Realtime-safe.
class ForceLimiter {
  public:
    static constexpr int ramp_ticks =
        15;  ///< within which a fault takes any force to zero; 5 ms to notice it are left
    static constexpr int return_ticks = 500;  ///< over which the force comes back after the last fault

    /// The largest force is max_force, or what max_force_rate takes to zero within ramp_ticks if that is
    /// less.
    explicit ForceLimiter(const HapticSettings& settings) noexcept
        : ForceLimiter(settings.max_force, settings.max_force_rate) {}
    /// The same of a torque, N mm.
    explicit ForceLimiter(const ToolSettings& settings) noexcept
        : ForceLimiter(settings.max_torque, settings.max_torque_rate) {}

    /// Lowers the largest force (N) to what a device bears.
    void lower_to(double max_force) noexcept { max_force_ = std::min(max_force_, max_force); }

    void reset() noexcept;

    /// Shortens `wanted` (N) to the largest force, then lets the force change by at most max_force_rate per
    /// tick; adds force_limited and rate_limited to `status`. With any of `faults` (to which a force that is
    /// not finite adds invalid_force), and for ramp_ticks after, the force goes to zero instead, in
    /// ramp_ticks equal steps, then comes back in proportion to the time since (status coming_back),
    /// growing by at most max_force / 100 a tick, so that a hand that pressed on meanwhile is not kicked.
    Eigen::Vector3d limit(const Eigen::Vector3d& wanted, std::uint32_t& faults,
                          std::uint32_t& status) noexcept;

  private:
    ForceLimiter(double most, double most_a_tick) noexcept
        : max_force_(std::min(most, ramp_ticks * most_a_tick)), max_step_(most_a_tick) {}
    Eigen::Vector3d ramp_to_zero() noexcept;

    double max_force_;
    double max_step_;
    Eigen::Vector3d last_ = Eigen::Vector3d::Zero();
    int ramp_left_ = 0;                           // steps to zero
    int ticks_well_ = ramp_ticks + return_ticks;  // since the last fault; counted no further than this
};

}  // namespace palpate::haptics
