// SPDX-License-Identifier: Apache-2.0
#include "runtime/realtime/servo.hpp"

#include "runtime/realtime/periodic_clock.hpp"

namespace palpate::realtime {
namespace {

constexpr int fifo_priority = 80;  // above everything that is not the kernel's own

}  // namespace

void PeriodicServo::start(OnTick on_tick) {
    thread_ = std::thread([this, on_tick = std::move(on_tick)] { run(on_tick); });
    ready_.wait(false);
}

void PeriodicServo::stop() {
    if (!thread_.joinable()) return;
    stop_requested_.store(true);
    thread_.join();
}

void PeriodicServo::run(const OnTick& on_tick) {
    if (priority_ == Priority::fifo) setup_.push_back(request_fifo_priority(fifo_priority));
    prefault_stack();
    PeriodicClock clock(period_ns);
    ready_.store(true);
    ready_.notify_one();
    while (!stop_requested_.load(std::memory_order_relaxed)) {
        const PeriodicClock::Wake wake = clock.wait();
        on_tick({1e-9 * static_cast<double>(wake.period * period_ns), wake.latency_ns, clock.overruns()});
    }
}

}  // namespace palpate::realtime
