// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <chrono>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <thread>

#include "runtime/realtime/periodic_clock.hpp"
#include "runtime/realtime/servo.hpp"
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

constexpr std::size_t deep = 128 * 1024;  // bytes, within prefaulted_stack
// Of a call, and some more; without prefault_stack() it is all of 32.
constexpr long few_pages = deep / 4096 / 4;

// Uses the stack as deep as that; returns how many pages it was the first to touch.
[[gnu::noinline]] long faults_of_a_deep_call() {
    rusage before{}, after{};
    getrusage(RUSAGE_THREAD, &before);
    [[maybe_unused]] volatile char stack[deep];
    for (std::size_t at = 0; at < deep; at += 1024) stack[at] = 1;
    getrusage(RUSAGE_THREAD, &after);
    return after.ru_minflt - before.ru_minflt;
}

TEST(ThreadSetup, a_prefaulted_stack_is_touched_before_a_deep_call_needs_it) {
#ifdef PALPATE_SANITIZED
    GTEST_SKIP() << "a sanitizer's own pages are touched with the stack's";
#endif
    std::thread([] {
        prefault_stack();
        EXPECT_LE(faults_of_a_deep_call(), few_pages);
    }).join();
}

// Its thread's stack, as seen from a tick.
TEST(ThreadSetup, a_periodic_servo_prefaults_its_stack) {
#ifdef PALPATE_SANITIZED
    GTEST_SKIP() << "a sanitizer's own pages are touched with the stack's";
#endif
    PeriodicServo servo(PeriodicServo::Priority::none);
    std::atomic<long> faults{-1};
    servo.start([&](const ServoTick&) {
        if (faults < 0) faults = faults_of_a_deep_call();
    });
    while (faults < 0) std::this_thread::yield();
    servo.stop();
    EXPECT_LE(faults, few_pages);
}

}  // namespace
}  // namespace palpate
