// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "runtime/doctor/finding.hpp"
#include "runtime/realtime/histogram.hpp"

namespace palpate::doctor {

/// How a thread that asks to be woken every millisecond was woken.
struct WakeUps {
    bool real_time = false;       ///< with SCHED_FIFO
    realtime::Histogram late_ns;  ///< by how much, each deadline once, those slept through included
    std::int64_t missed = 0;      ///< deadlines slept through

    /// Counts one wake-up; `missed_so_far` as in ServoTick::overruns. Realtime-safe.
    void add(std::int64_t late, std::int64_t missed_so_far) noexcept;

  private:
    std::int64_t last_late_ = 0;
};

/// Measures the wake-ups of the runtime's own servo, with what priority it is granted, for `seconds` > 0.
WakeUps measure_servo(double seconds);
/// The same in a thread without real-time priority.
WakeUps measure_without_priority(double seconds);

/// What a tick is given to compute in, ns: the most that 99.9 % of ticks may take.
inline constexpr std::int64_t tick_budget_ns = 100'000;

/// The highest rate of 1000, 500 and 250 Hz whose period is longer than what 99.9 % of the wake-ups are late
/// by and tick_budget_ns together; 0 if none is.
int rate_held(const WakeUps& wake_ups);

/// What the two measurements say of this machine.
Findings wake_up_findings(const WakeUps& servo, const WakeUps& without_priority, Purpose purpose);

}  // namespace palpate::doctor
