// SPDX-License-Identifier: Apache-2.0
#include "tests/runtime/devices/openhaptics/hd_library/hd_scheduler.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <utility>

#include "runtime/realtime/periodic_clock.hpp"

namespace palpate::hd {

using namespace realtime;

void Scheduler::configure(bool virtual_clock, std::int64_t pause_after_ticks, TickHooks hooks) {
    slots_ = {};
    hooks_ = std::move(hooks);
    virtual_clock_ = virtual_clock;
    pause_after_ticks_ = pause_after_ticks;
    ticks_ = 0;
}

void Scheduler::start() {
    if (running_.exchange(true)) return;
    thread_ = std::thread([this] { run(); });
}

void Scheduler::stop() {
    {
        const std::lock_guard lock(mutex_);
        if (!running_.exchange(false)) return;
    }
    changed_.notify_all();
    thread_.join();
    servo_ = std::thread::id();
}

bool Scheduler::may_tick() const noexcept {
    return ticks_ < pause_after_ticks_ &&
           (!virtual_clock_ || std::ranges::any_of(slots_, [](const Slot& s) { return s.handle != 0; }));
}

void Scheduler::run() {
    servo_ = std::this_thread::get_id();
    PeriodicClock clock(period_ns_);
    std::int64_t period = 0;
    while (running_) {
        {
            std::unique_lock lock(mutex_);
            if (virtual_clock_ || ticks_ >= pause_after_ticks_)
                changed_.wait(lock, [this] { return !running_ || may_tick(); });
        }
        if (!running_) return;
        std::int64_t gone = 1;
        if (!virtual_clock_) gone = clock.wait().period - std::exchange(period, period + 1);
        period += gone - 1;
        ticks_ += gone;
        tick();
        const double seconds = 1e-9 * static_cast<double>(period_ns_);
        const double time = seconds * static_cast<double>(ticks_);
        const double stall = hooks_.stalled_until(time) - time;
        if (stall <= 0) continue;
        if (virtual_clock_)
            ticks_ += std::llround(stall / seconds) - 1;
        else
            std::this_thread::sleep_for(std::chrono::duration<double>(stall));
    }
}

void Scheduler::tick() {
    const std::int64_t now = monotonic_ns();
    if (!virtual_clock_ && tick_begin_ns_ != 0)
        instantaneous_rate_ = 1e9 / static_cast<double>(std::max<std::int64_t>(1, now - tick_begin_ns_));
    tick_begin_ns_ = now;
    hooks_.begin(1e-9 * static_cast<double>(period_ns_ * ticks_));
    std::array<std::pair<unsigned, std::uint64_t>, most> order;  // highest priority, then first come
    std::size_t count = 0;
    {
        const std::lock_guard lock(mutex_);
        for (const Slot& slot : slots_)
            if (slot.handle != 0) order[count++] = {~slot.priority, slot.handle};
    }
    std::sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count));
    for (std::size_t i = 0; i < count; ++i) {
        std::unique_lock lock(mutex_);
        Slot* slot = find(order[i].second);
        if (!slot) continue;
        slot->running = true;
        lock.unlock();
        const unsigned answer = slot->function(slot->data);
        lock.lock();
        slot->running = false;
        if (answer == callback_done && slot->handle == order[i].second) slot->handle = 0;
        lock.unlock();
        changed_.notify_all();
    }
    hooks_.end();
}

double Scheduler::since_tick() const noexcept {
    if (virtual_clock_ || tick_begin_ns_ == 0) return 0;
    return 1e-9 * static_cast<double>(monotonic_ns() - tick_begin_ns_);
}

Scheduler::Slot* Scheduler::find(std::uint64_t handle) noexcept {
    const auto slot = std::ranges::find(slots_, handle, &Slot::handle);
    return handle == 0 || slot == slots_.end() ? nullptr : &*slot;
}

std::uint64_t Scheduler::schedule(Callback function, void* data, unsigned priority) {
    const std::lock_guard lock(mutex_);
    const auto slot = std::ranges::find_if(slots_, [](const Slot& s) { return s.handle == 0 && !s.running; });
    if (slot == slots_.end()) return 0;
    *slot = {++handles_, function, data, priority, false};
    changed_.notify_all();
    return slot->handle;
}

bool Scheduler::unschedule(std::uint64_t handle) {
    std::unique_lock lock(mutex_);
    Slot* slot = find(handle);
    if (!slot) return false;
    slot->handle = 0;
    if (!in_servo_thread()) changed_.wait(lock, [&] { return !slot->running; });
    return true;
}

bool Scheduler::is_scheduled(std::uint64_t handle) {
    const std::lock_guard lock(mutex_);
    return find(handle) != nullptr;
}

void Scheduler::wait_for(std::uint64_t handle) {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return !running_ || !find(handle); });
}

}  // namespace palpate::hd
