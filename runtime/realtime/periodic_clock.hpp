// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

namespace palpate::realtime {

/// Monotonic time in nanoseconds. Realtime-safe.
std::int64_t monotonic_ns() noexcept;

/// Wakes its thread at start + k * period. Deadlines are absolute, so errors do not add up; a deadline that
/// is already past when wait() is called is skipped, as are those behind it, and each is counted.
/// Realtime-safe.
class PeriodicClock {
  public:
    /// What one wait() found.
    struct Wake {
        std::int64_t period = 0;       ///< k of the deadline waited for; 1 for the first
        std::int64_t deadline_ns = 0;  ///< monotonic
        std::int64_t latency_ns = 0;   ///< woke this long after the deadline
    };

    /// `period_ns` > 0; the first deadline is one period from now.
    explicit PeriodicClock(std::int64_t period_ns) noexcept;
    Wake wait() noexcept;
    std::int64_t overruns() const noexcept { return overruns_; }  ///< periods skipped so far

  private:
    std::int64_t period_ns_;
    std::int64_t start_ns_;
    std::int64_t period_ = 0;
    std::int64_t overruns_ = 0;
};

}  // namespace palpate::realtime
