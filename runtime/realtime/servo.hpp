// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <thread>
#include <vector>

#include "runtime/realtime/thread_setup.hpp"

namespace palpate::realtime {

/// One wake-up of a servo.
struct ServoTick {
    double time = 0;                   ///< s since it started: a whole number of periods
    std::int64_t wake_latency_ns = 0;  ///< woke this long after the deadline
    std::int64_t overruns = 0;         ///< periods skipped so far
};

/// A thread that calls one function a thousand times a second: this process's own, or a device driver's.
class Servo {
  public:
    static constexpr std::int64_t period_ns = 1'000'000;
    /// Must not throw.
    using OnTick = std::function<void(const ServoTick&)>;

    virtual ~Servo() = default;
    /// Starts calling `on_tick` every period; returns once the thread is set up. Throws SystemFailure where
    /// that cannot be.
    virtual void start(OnTick on_tick) = 0;
    /// Ends the calls; none is running when it returns. May be called again.
    virtual void stop() = 0;
    /// What the operating system granted. Not while it starts.
    virtual std::vector<SetupResult> setup() const { return {}; }
};

/// A servo in a thread of its own. Starts once only.
class PeriodicServo final : public Servo {
  public:
    /// With SCHED_FIFO where permitted, or with the priority of any other thread.
    enum class Priority { fifo, none };
    explicit PeriodicServo(Priority priority = Priority::fifo) : priority_(priority) {}
    PeriodicServo(const PeriodicServo&) = delete;
    PeriodicServo& operator=(const PeriodicServo&) = delete;
    ~PeriodicServo() override { stop(); }

    void start(OnTick on_tick) override;
    void stop() override;
    std::vector<SetupResult> setup() const override { return setup_; }

  private:
    void run(const OnTick& on_tick);

    Priority priority_;
    std::vector<SetupResult> setup_;
    std::atomic<bool> stop_requested_{false};
    std::atomic<bool> ready_{false};
    std::thread thread_;
};

}  // namespace palpate::realtime
