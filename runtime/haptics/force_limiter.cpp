// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/force_limiter.hpp"

#include "runtime/haptics/tick_result.hpp"

namespace palpate {
namespace {

// Shortens `v` to `limit`; tells whether it had to.
bool shorten(Eigen::Vector3d& v, double limit) noexcept {
    const double length = v.norm();
    if (length <= limit) return false;
    v *= limit / length;
    return true;
}

}  // namespace

Eigen::Vector3d ForceLimiter::limit(const Eigen::Vector3d& wanted, std::uint32_t& status) noexcept {
    if (!wanted.allFinite()) {
        status |= invalid_position;
        return ramp_to_zero();
    }
    Eigen::Vector3d force = wanted;
    if (shorten(force, max_force_)) status |= force_limited;
    Eigen::Vector3d step = force - last_;
    if (shorten(step, max_step_)) {
        status |= rate_limited;
        force = last_ + step;
    }
    last_ = force;
    return last_;
}

Eigen::Vector3d ForceLimiter::ramp_to_zero() noexcept {
    Eigen::Vector3d step = -last_;
    shorten(step, max_force_ / 20);
    last_ += step;
    return last_;
}

}  // namespace palpate
