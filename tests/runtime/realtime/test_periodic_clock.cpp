// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <gtest/gtest.h>
#include <thread>

#include "runtime/realtime/periodic_clock.hpp"
#include "runtime/realtime/thread_setup.hpp"

namespace palpate {
namespace {

using namespace realtime;

TEST(PeriodicClock, deadlines_are_whole_periods_apart_and_never_early) {
    PeriodicClock clock(1'000'000);
    PeriodicClock::Wake last = clock.wait();
    for (int i = 0; i < 50; ++i) {
        const PeriodicClock::Wake wake = clock.wait();
        EXPECT_GE(wake.latency_ns, 0);
        EXPECT_GE(monotonic_ns(), wake.deadline_ns);
        EXPECT_EQ(wake.deadline_ns - last.deadline_ns, (wake.period - last.period) * 1'000'000);
        EXPECT_GE(wake.period, last.period + 1);
        last = wake;
    }
}

TEST(PeriodicClock, skips_and_counts_the_deadlines_that_were_slept_through) {
    PeriodicClock clock(1'000'000);
    const PeriodicClock::Wake before = clock.wait();
    const std::int64_t overruns = clock.overruns();
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    const PeriodicClock::Wake after = clock.wait();
    EXPECT_GE(after.period - before.period, 10);
    EXPECT_EQ(clock.overruns() - overruns, after.period - before.period - 1);
}

TEST(ThreadSetup, says_what_was_done_or_why_not) {
    std::thread([] {
        EXPECT_FALSE(request_fifo_priority(10).message.empty());
        EXPECT_FALSE(request_fifo_priority(1000).ok);
    }).join();
}

}  // namespace
}  // namespace palpate
