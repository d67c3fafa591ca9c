// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <gtest/gtest.h>
#include <stdexcept>
#include <thread>

#include "runtime/realtime/servo.hpp"
#include "runtime/realtime/servo_callbacks.hpp"

namespace palpate {
namespace {

using namespace realtime;

using Then = ServoCallbacks::Then;

struct Counter {
    int runs = 0, until = 1;
};

Then count(void* data) noexcept {
    auto& counter = *static_cast<Counter*>(data);
    return ++counter.runs >= counter.until ? Then::done : Then::again;
}

// Ticks the callbacks until it is destroyed.
class Ticking {
  public:
    explicit Ticking(ServoCallbacks& callbacks) {
        servo_.start([&callbacks](const ServoTick&) { callbacks.tick(); });
    }

  private:
    PeriodicServo servo_;
};

TEST(ServoCallbacks, an_asynchronous_one_runs_each_tick_until_it_is_done) {
    ServoCallbacks callbacks;
    Counter three{.until = 3};
    callbacks.schedule(count, &three);
    for (int tick = 0; tick < 10; ++tick) callbacks.tick();
    EXPECT_EQ(three.runs, 3);
}

TEST(ServoCallbacks, a_synchronous_one_has_run_when_the_caller_goes_on) {
    ServoCallbacks callbacks;
    const Ticking ticking(callbacks);
    for (int i = 0; i < 50; ++i) {
        Counter once;
        ASSERT_TRUE(callbacks.run(count, &once));
        ASSERT_EQ(once.runs, 1);
    }
}

TEST(ServoCallbacks, a_synchronous_one_gives_up_where_no_servo_ticks) {
    ServoCallbacks callbacks;
    Counter once;
    EXPECT_FALSE(callbacks.run(count, &once, std::chrono::milliseconds(20)));
    callbacks.tick();
    EXPECT_EQ(once.runs, 0);
}

TEST(ServoCallbacks, one_that_was_taken_back_runs_no_more) {
    ServoCallbacks callbacks;
    const Ticking ticking(callbacks);
    Counter endless{.until = 1'000'000'000};
    const ServoCallbacks::Handle handle = callbacks.schedule(count, &endless);
    while (!callbacks.run(
        [](void* data) noexcept { return static_cast<Counter*>(data)->runs > 2 ? Then::done : Then::again; },
        &endless)) {
    }
    callbacks.unschedule(handle);
    const int runs = endless.runs;
    Counter later{.until = 3};
    ASSERT_TRUE(callbacks.run(count, &later));
    EXPECT_EQ(endless.runs, runs);
    callbacks.unschedule(handle);  // an old handle is good for nothing, and harms nothing
}

TEST(ServoCallbacks, callers_in_many_threads_do_not_get_into_each_others_way) {
    ServoCallbacks callbacks;
    const Ticking ticking(callbacks);
    std::array<Counter, 8> counters;
    std::array<std::thread, 8> threads;
    for (std::size_t t = 0; t < threads.size(); ++t)
        threads[t] = std::thread([&callbacks, &counter = counters[t]] {
            for (int i = 0; i < 20; ++i) callbacks.run(count, &counter);
        });
    for (std::thread& thread : threads) thread.join();
    for (const Counter& counter : counters) EXPECT_EQ(counter.runs, 20);
}

TEST(ServoCallbacks, more_than_there_is_room_for_are_refused) {
    ServoCallbacks callbacks;
    Counter endless{.until = 1'000'000'000};
    for (std::size_t i = 0; i < ServoCallbacks::most; ++i) callbacks.schedule(count, &endless);
    EXPECT_THROW(callbacks.schedule(count, &endless), std::length_error);
}

}  // namespace
}  // namespace palpate
