// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cstdint>

#include "formats/model/body.hpp"

namespace palpate {

/// Keeps the commanded force within what device and hand may bear. Realtime-safe.
class ForceLimiter {
  public:
    explicit ForceLimiter(const HapticSettings& settings) noexcept
        : max_force_(settings.max_force), max_step_(settings.max_force_rate) {}

    /// Lowers the largest force (N) to what a device bears.
    void lower_to(double max_force) noexcept { max_force_ = std::min(max_force_, max_force); }

    void reset() noexcept { last_.setZero(); }

    /// Shortens `wanted` (N) to max_force, then lets the force change by at most max_force_rate per tick;
    /// adds force_limited and rate_limited to `status`. A force that is not finite counts as a fault.
    Eigen::Vector3d limit(const Eigen::Vector3d& wanted, std::uint32_t& status) noexcept;

    /// Takes the force towards zero, reaching it within 20 ticks from any force.
    Eigen::Vector3d ramp_to_zero() noexcept;

  private:
    double max_force_;
    double max_step_;
    Eigen::Vector3d last_ = Eigen::Vector3d::Zero();
};

}  // namespace palpate
