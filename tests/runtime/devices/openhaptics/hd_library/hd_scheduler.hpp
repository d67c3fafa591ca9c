// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>

#include "tests/runtime/devices/openhaptics/hd_library/hd_types.hpp"

namespace palpate::hd {

/// What the scheduler does about the devices in each tick.
struct TickHooks {
    std::function<void(double time)> begin;
    std::function<void()> end;
    std::function<double(double time)> stalled_until;
};

/// The servo thread and the functions it calls once a tick, those of high priority first. Time goes on in
/// whole periods; on the virtual clock it stands still while nothing is scheduled. Safe from any thread.
class Scheduler {
  public:
    static constexpr std::size_t most = 32;  ///< functions at one time

    /// Forgets everything; the servo must be stopped.
    void configure(bool virtual_clock, std::int64_t pause_after_ticks, TickHooks hooks);

    void start();
    void stop();
    bool running() const noexcept { return running_; }
    bool in_servo_thread() const noexcept { return std::this_thread::get_id() == servo_; }
    void set_rate(int rate_hz) noexcept { period_ns_ = 1'000'000'000 / rate_hz; }
    int rate_hz() const noexcept { return static_cast<int>(1'000'000'000 / period_ns_); }
    /// Since the tick began, s; 0 on the virtual clock.
    double since_tick() const noexcept;
    /// One over the time from tick to tick, Hz.
    double instantaneous_rate() const noexcept { return instantaneous_rate_; }

    /// Returns the function's handle, which does not fit 32 bits, or 0 if there are too many.
    std::uint64_t schedule(Callback function, void* data, unsigned priority);
    /// Takes a function back and waits until it does not run any more; false if it has gone already.
    bool unschedule(std::uint64_t handle);
    bool is_scheduled(std::uint64_t handle);
    void wait_for(std::uint64_t handle);

  private:
    struct Slot {
        std::uint64_t handle = 0;  // 0: free
        Callback function = nullptr;
        void* data = nullptr;
        unsigned priority = 0;
        bool running = false;
    };
    void run();
    void tick();
    Slot* find(std::uint64_t handle) noexcept;
    bool may_tick() const noexcept;

    std::mutex mutex_;
    std::condition_variable changed_;
    std::array<Slot, most> slots_;
    std::uint64_t handles_ = std::uint64_t{1} << 32;
    TickHooks hooks_;
    bool virtual_clock_ = false;
    std::int64_t pause_after_ticks_ = 0, ticks_ = 0;
    std::atomic<std::int64_t> period_ns_{1'000'000}, tick_begin_ns_{0};
    std::atomic<double> instantaneous_rate_{1000};
    std::atomic<bool> running_{false};
    std::atomic<std::thread::id> servo_{};
    std::thread thread_;
};

}  // namespace palpate::hd
