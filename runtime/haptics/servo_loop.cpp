// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/servo_loop.hpp"

#include <algorithm>
#include <chrono>
#include <string>
#include <thread>
#include <utility>

#include "formats/model/errors.hpp"
#include "runtime/realtime/periodic_clock.hpp"

namespace palpate::haptics {

using namespace realtime;
namespace {

constexpr std::chrono::milliseconds patience(250);  // for a servo that has forces to take to zero

}  // namespace

ServoLoop::ServoLoop(HapticModel& model, std::span<Device* const> devices, Servo* servo,
                     std::size_t ring_capacity)
    : model_(&model),
      devices_(devices.begin(), devices.end()),
      servo_(servo ? *servo : own_servo_),
      states_(devices.size()),
      results_(devices.size()),
      outlet_(devices.size(), ring_capacity) {
    couple(model);
}

void ServoLoop::couple(HapticModel& model) const {
    if (devices_.size() != model.tool_count())
        throw InvalidInput({"servo loop", std::to_string(devices_.size()) + " devices",
                            std::to_string(model.tool_count()) + ", one for each tool", ""});
    std::vector<DeviceLimits> limits;
    for (const Device* device : devices_) limits.push_back(device->limits());
    model.couple_to(limits);
}

ServoLoop::~ServoLoop() {
    stop();
}

void ServoLoop::start() {
    statistics_.setup.push_back(lock_memory());
    servo_.start([this](const ServoTick& wake) { step(wake); });
    running_ = true;
    std::ranges::copy(servo_.setup(), std::back_inserter(statistics_.setup));
    detect_beside(model_.load()->detects());
}

void ServoLoop::detect_beside(Detects detects) {
    if (detects == detected_) return;
    detected_ = detects;
    collision_.reset();
    if (detects == Detects::nothing) return;
    collision_.emplace([this] { model_.load()->detect(); }, CollisionLoop::period_of(detects));
    collision_->start();
}

bool ServoLoop::change_model(HapticModel& model) {
    couple(model);
    next_model_.store(&model);
    const auto give_up = std::chrono::steady_clock::now() + patience;
    while (next_model_.load() != nullptr && std::chrono::steady_clock::now() < give_up)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    if (next_model_.exchange(nullptr) != nullptr) return false;
    detect_beside(model.detects());
    return true;
}

void ServoLoop::stop() {
    if (!running_) return;
    running_ = false;
    stopping_.store(true);
    const auto give_up = std::chrono::steady_clock::now() + patience;
    while (!released_.load() && std::chrono::steady_clock::now() < give_up)
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    servo_.stop();
    collision_.reset();
}

void ServoLoop::run_virtual(std::int64_t ticks, const std::function<void(const TickResult&)>& sink,
                            const std::function<ServoTick(std::int64_t)>& wake) {
    for (std::int64_t tick = 1; tick <= ticks; ++tick) {
        step(wake(tick));
        for (const TickResult& result : results_) sink(result);
        HapticModel& model = *model_.load();
        const std::int64_t detection_ns = CollisionLoop::period_of(model.detects());
        if (tick * period_ns / detection_ns > (tick - 1) * period_ns / detection_ns) model.detect();
    }
    for (Device* device : devices_) device->write({});
}

void ServoLoop::set_fault(Fault fault, bool there) noexcept {
    if (there)
        faults_.fetch_or(fault, std::memory_order_relaxed);
    else
        faults_.fetch_and(~std::uint32_t{fault}, std::memory_order_relaxed);
}

void ServoLoop::visual_beat() noexcept {
    visual_beat_ns_.store(monotonic_ns(), std::memory_order_relaxed);
}

std::uint32_t ServoLoop::faults_of(const ServoTick& wake, std::int64_t now_ns) noexcept {
    std::uint32_t faults = faults_.load(std::memory_order_relaxed);
    const bool late = wake.wake_latency_ns >= late_periods * period_ns;
    if (late || wake.overruns - statistics_.overruns >= late_periods) faults |= tick_late;
    const std::int64_t beat = visual_beat_ns_.load(std::memory_order_relaxed);
    if (beat != 0 && now_ns - beat > visual_patience_ns) faults |= visual_stopped;
    const bool changing = next_model_.load(std::memory_order_relaxed) != nullptr;
    if (stopping_.load(std::memory_order_relaxed) || changing || std::exchange(model_is_new_, false))
        faults |= servo_stopping;
    return faults;
}

void ServoLoop::step(const ServoTick& wake) noexcept {
    callbacks_.tick();
    const std::int64_t begin = monotonic_ns();
    for (std::size_t t = 0; t < devices_.size(); ++t) {
        states_[t] = devices_[t]->read(wake.time);
        states_[t].time = wake.time;
    }
    model_.load(std::memory_order_relaxed)->tick(states_, results_, faults_of(wake, begin));
    for (std::size_t t = 0; t < devices_.size(); ++t)
        devices_[t]->write({results_[t].force, results_[t].torque});
    const std::int64_t tick_ns = monotonic_ns() - begin;
    for (std::size_t t = 0; t < devices_.size(); ++t) {
        results_[t].tick_ns = tick_ns;
        results_[t].wake_latency_ns = wake.wake_latency_ns;
        results_[t].overruns = static_cast<std::uint32_t>(wake.overruns);
    }
    outlet_.publish(results_);
    const std::int64_t whole_ns = monotonic_ns() - begin;
    ++statistics_.ticks;
    statistics_.overruns = wake.overruns;
    statistics_.tick_ns.record(static_cast<std::uint64_t>(std::max<std::int64_t>(0, whole_ns)));
    statistics_.wake_latency_ns.record(static_cast<std::uint64_t>(wake.wake_latency_ns));
    if (stopping_.load(std::memory_order_relaxed)) count_stopping();
    if (HapticModel* next = next_model_.load()) change_over(*next);
}

void ServoLoop::change_over(HapticModel& next) noexcept {
    if (++ticks_changing_ <= ForceLimiter::ramp_ticks) return;
    ticks_changing_ = 0;
    next.count_from(model_.load()->next_tick());
    // Whoever asked may have given up meanwhile.
    HapticModel* asked = &next;
    HapticModel* before = model_.exchange(&next);
    model_is_new_ = next_model_.compare_exchange_strong(asked, nullptr);
    if (!model_is_new_) model_.store(before);
}

// A hand that presses must not be dropped: the last force has gone to zero before the servo ends.
void ServoLoop::count_stopping() noexcept {
    if (++ticks_stopping_ > ForceLimiter::ramp_ticks) released_.store(true, std::memory_order_relaxed);
}

ServoStatistics ServoLoop::statistics() const {
    ServoStatistics statistics = statistics_;
    statistics.lost_records = outlet_.ring().dropped();
    return statistics;
}

}  // namespace palpate::haptics
