// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <cstdint>
#include <vector>

#include "runtime/devices/openhaptics/hd_api.hpp"
#include "runtime/devices/openhaptics/hd_device.hpp"
#include "runtime/realtime/servo.hpp"

namespace palpate::devices {

/// The scheduler of an HDAPI library as a servo: one callback for all devices, in the driver's thread. Time
/// is the number of ticks times a period. Two ticks that are n >= 2 periods apart, to the nearest whole, are
/// n - 1 overruns. May be started again after stop().
class HdServo final : public realtime::Servo {
  public:
    /// `api` and `devices`, all that are open, must outlive this. `notes`: what setup() tells beside the
    /// rate.
    HdServo(const HdApi& api, std::vector<HdDevice*> devices, std::vector<realtime::SetupResult> notes);
    HdServo(const HdServo&) = delete;
    HdServo& operator=(const HdServo&) = delete;
    ~HdServo() override { stop(); }

    /// Starts the scheduler, at 1 kHz where the driver lets itself be told, and the ticks; returns after the
    /// first. Throws SystemFailure with cause and fix.
    void start(OnTick on_tick) override;
    /// Ticks once, and once more for zero force on all devices; the scheduler goes on. Throws as start().
    void tick_once(OnTick on_tick);
    /// Ends the ticks, then the scheduler.
    void stop() override;
    /// The rate that the driver tells, then the notes.
    std::vector<realtime::SetupResult> setup() const override;

  private:
    static unsigned callback(void* servo) noexcept;
    unsigned tick() noexcept;
    void time_tick() noexcept;
    void release() noexcept;
    void start_scheduler();
    void schedule(OnTick on_tick, std::int64_t most_ticks);
    void end_ticks();

    const HdApi& api_;
    std::vector<HdDevice*> devices_;
    std::vector<realtime::SetupResult> notes_;
    OnTick on_tick_;
    HdOperation operation_ = 0;
    bool scheduler_runs_ = false, scheduled_ = false;
    std::atomic<bool> ending_{false}, released_{false}, inside_{false};
    std::atomic<bool> ticked_{false};
    realtime::ServoTick tick_;  // the scheduler's thread's, as are the next three
    std::int64_t ticks_ = 0, most_ticks_ = 0;
    std::int64_t last_ns_ = 0;  // when the last tick began
};

}  // namespace palpate::devices
