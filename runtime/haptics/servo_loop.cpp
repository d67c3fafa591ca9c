// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/servo_loop.hpp"

#include <algorithm>

namespace palpate {
namespace {

constexpr int fifo_priority = 80;  // above everything that is not the kernel's own

}  // namespace

ServoLoop::ServoLoop(HapticModel& model, Device& device, std::size_t ring_capacity)
    : model_(model), device_(device), latest_(TickResult{}), ring_(ring_capacity), result_{} {}

ServoLoop::~ServoLoop() {
    stop();
}

void ServoLoop::start() {
    statistics_.setup.push_back(lock_memory());
    thread_ = std::thread([this] { run(); });
    ready_.wait(false);
}

void ServoLoop::stop() {
    if (!thread_.joinable()) return;
    stop_requested_.store(true);
    thread_.join();
}

void ServoLoop::run() {
    statistics_.setup.push_back(request_fifo_priority(fifo_priority));
    PeriodicClock clock(period_ns);
    ready_.store(true);
    ready_.notify_one();
    while (!stop_requested_.load(std::memory_order_relaxed)) {
        const PeriodicClock::Wake wake = clock.wait();
        step(1e-9 * static_cast<double>(wake.period * period_ns), wake.latency_ns, clock.overruns());
    }
    let_go(clock);
}

// A hand that presses must not be dropped: the force ends as for a lost device, within 20 ms.
void ServoLoop::let_go(PeriodicClock& clock) noexcept {
    constexpr int ramp_ticks = 20;
    for (int tick = 0; tick < ramp_ticks; ++tick) {
        clock.wait();
        DeviceState state = device_.read(result_.time);
        state.connected = false;
        model_.tick(state, result_);
        device_.write(result_.force);
    }
    device_.write({0, 0, 0});
}

void ServoLoop::run_virtual(std::int64_t ticks, const std::function<void(const TickResult&)>& sink) {
    for (std::int64_t tick = 1; tick <= ticks; ++tick) {
        step(1e-9 * static_cast<double>(tick * period_ns), 0, 0);
        sink(result_);
    }
    device_.write({0, 0, 0});
}

void ServoLoop::step(double time, std::int64_t wake_latency_ns, std::int64_t overruns) noexcept {
    const std::int64_t begin = monotonic_ns();
    DeviceState state = device_.read(time);
    state.time = time;
    model_.tick(state, result_);
    device_.write(result_.force);
    result_.tick_ns = monotonic_ns() - begin;
    result_.wake_latency_ns = wake_latency_ns;
    result_.overruns = static_cast<std::uint32_t>(overruns);

    latest_.write(result_);
    ring_.push(result_);
    ++statistics_.ticks;
    statistics_.overruns = overruns;
    statistics_.tick_ns.record(static_cast<std::uint64_t>(std::max<std::int64_t>(0, result_.tick_ns)));
    statistics_.wake_latency_ns.record(static_cast<std::uint64_t>(wake_latency_ns));
}

ServoStatistics ServoLoop::statistics() const {
    ServoStatistics statistics = statistics_;
    statistics.lost_records = ring_.dropped();
    return statistics;
}

}  // namespace palpate
