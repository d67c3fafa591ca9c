// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/force_limiter.hpp"

#include <algorithm>

#include "formats/records/tick_result.hpp"

namespace palpate::haptics {
namespace {

constexpr int gentle_ticks = 100;  // that a force takes at least to grow from zero to the largest one

// Shortens `v` to `limit`; tells whether it had to.
bool shorten(Eigen::Vector3d& v, double limit) noexcept {
    const double length = v.norm();
    if (length <= limit) return false;
    v *= limit / length;
    return true;
}

}  // namespace

void ForceLimiter::reset() noexcept {
    last_.setZero();
    ticks_well_ = ramp_ticks + return_ticks;
}

Eigen::Vector3d ForceLimiter::limit(const Eigen::Vector3d& wanted, std::uint32_t& faults,
                                    std::uint32_t& status) noexcept {
    if (!wanted.allFinite()) faults |= invalid_force;
    if (faults != no_fault && ticks_well_ >= ramp_ticks) ramp_left_ = ramp_ticks;
    ticks_well_ = faults != no_fault ? 0 : std::min(ticks_well_ + 1, ramp_ticks + return_ticks);
    if (ticks_well_ > 0 && ticks_well_ < ramp_ticks + return_ticks) status |= coming_back;
    if (ticks_well_ < ramp_ticks) return ramp_to_zero();
    const double share = static_cast<double>(ticks_well_ - ramp_ticks) / return_ticks;
    Eigen::Vector3d force = share * wanted;
    if (shorten(force, share * max_force_)) status |= force_limited;
    // Where what is wanted jumps, as a published scheme's force does, it still comes back gently.
    if (share < 1) shorten(force, last_.norm() + max_force_ / gentle_ticks);
    Eigen::Vector3d step = force - last_;
    if (shorten(step, max_step_)) {
        status |= rate_limited;
        force = last_ + step;
    }
    last_ = force;
    return last_;
}

// In equal steps: a small force is not dropped at once.
Eigen::Vector3d ForceLimiter::ramp_to_zero() noexcept {
    if (ramp_left_ > 0) {
        last_ *= (ramp_left_ - 1.0) / ramp_left_;
        --ramp_left_;
    }
    return last_;
}

}  // namespace palpate::haptics
