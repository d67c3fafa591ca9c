// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/servo_loop.hpp"

#include <algorithm>
#include <string>

#include "formats/model/errors.hpp"

namespace palpate {
namespace {

constexpr int fifo_priority = 80;  // above everything that is not the kernel's own

}  // namespace

ServoLoop::ServoLoop(HapticModel& model, std::span<Device* const> devices, std::size_t ring_capacity)
    : model_(model),
      devices_(devices.begin(), devices.end()),
      states_(devices.size()),
      results_(devices.size()),
      ring_(ring_capacity),
      collision_([&model] { model.detect(); }) {
    if (devices.size() != model.tool_count())
        throw InvalidInput({"servo loop", std::to_string(devices.size()) + " devices",
                            std::to_string(model.tool_count()) + ", one for each tool", ""});
    std::vector<DeviceLimits> limits;
    for (const Device* device : devices_) {
        limits.push_back(device->limits());
        latest_.push_back(std::make_unique<TripleBuffer<TickResult>>());
    }
    model.couple_to(limits);
}

ServoLoop::~ServoLoop() {
    stop();
}

void ServoLoop::start() {
    statistics_.setup.push_back(lock_memory());
    thread_ = std::thread([this] { run(); });
    ready_.wait(false);
    if (model_.scheme() != ContactScheme::continuous) collision_.start();
}

void ServoLoop::stop() {
    if (!thread_.joinable()) return;
    stop_requested_.store(true);
    thread_.join();
    collision_.stop();
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
        for (std::size_t t = 0; t < devices_.size(); ++t) {
            states_[t] = devices_[t]->read(results_[t].time);
            states_[t].connected = false;
        }
        model_.tick(states_, results_);
        write_forces();
    }
    release();
}

void ServoLoop::run_virtual(std::int64_t ticks, const std::function<void(const TickResult&)>& sink) {
    for (std::int64_t tick = 1; tick <= ticks; ++tick) {
        step(1e-9 * static_cast<double>(tick * period_ns), 0, 0);
        for (const TickResult& result : results_) sink(result);
        if (tick * period_ns / CollisionLoop::period_ns > (tick - 1) * period_ns / CollisionLoop::period_ns)
            model_.detect();
    }
    release();
}

void ServoLoop::write_forces() noexcept {
    for (std::size_t t = 0; t < devices_.size(); ++t) devices_[t]->write(results_[t].force);
}

void ServoLoop::release() noexcept {
    for (Device* device : devices_) device->write({0, 0, 0});
}

void ServoLoop::step(double time, std::int64_t wake_latency_ns, std::int64_t overruns) noexcept {
    const std::int64_t begin = monotonic_ns();
    for (std::size_t t = 0; t < devices_.size(); ++t) {
        states_[t] = devices_[t]->read(time);
        states_[t].time = time;
    }
    model_.tick(states_, results_);
    write_forces();
    const std::int64_t tick_ns = monotonic_ns() - begin;
    for (std::size_t t = 0; t < devices_.size(); ++t) {
        results_[t].tick_ns = tick_ns;
        results_[t].wake_latency_ns = wake_latency_ns;
        results_[t].overruns = static_cast<std::uint32_t>(overruns);
        latest_[t]->write(results_[t]);
        ring_.push(results_[t]);
    }
    ++statistics_.ticks;
    statistics_.overruns = overruns;
    statistics_.tick_ns.record(static_cast<std::uint64_t>(std::max<std::int64_t>(0, tick_ns)));
    statistics_.wake_latency_ns.record(static_cast<std::uint64_t>(wake_latency_ns));
}

ServoStatistics ServoLoop::statistics() const {
    ServoStatistics statistics = statistics_;
    statistics.lost_records = ring_.dropped();
    return statistics;
}

}  // namespace palpate
