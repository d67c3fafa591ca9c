// SPDX-License-Identifier: Apache-2.0
#include "runtime/realtime/periodic_clock.hpp"

#include <algorithm>
#include <cerrno>
#include <time.h>

namespace palpate::realtime {
namespace {

constexpr std::int64_t second_ns = 1'000'000'000;

}  // namespace

std::int64_t monotonic_ns() noexcept {
    timespec now{};
    clock_gettime(CLOCK_MONOTONIC, &now);
    return std::int64_t{now.tv_sec} * second_ns + now.tv_nsec;
}

PeriodicClock::PeriodicClock(std::int64_t period_ns) noexcept
    : period_ns_(period_ns), start_ns_(monotonic_ns()) {}

PeriodicClock::Wake PeriodicClock::wait() noexcept {
    const std::int64_t passed = (monotonic_ns() - start_ns_) / period_ns_;
    const std::int64_t next = std::max(period_ + 1, passed + 1);
    overruns_ += next - (period_ + 1);
    period_ = next;
    const std::int64_t deadline = start_ns_ + period_ * period_ns_;
    const timespec until{.tv_sec = deadline / second_ns, .tv_nsec = deadline % second_ns};
    while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
    }
    return {period_, deadline, std::max<std::int64_t>(0, monotonic_ns() - deadline)};
}

}  // namespace palpate::realtime
