// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <cstdint>
#include <functional>
#include <string>
#include <thread>
#include <vector>

#include "runtime/haptics/haptic_model.hpp"
#include "runtime/haptics/tick_result.hpp"
#include "runtime/realtime/device.hpp"
#include "runtime/realtime/histogram.hpp"
#include "runtime/realtime/periodic_clock.hpp"
#include "runtime/realtime/spsc_ring.hpp"
#include "runtime/realtime/thread_setup.hpp"
#include "runtime/realtime/triple_buffer.hpp"

namespace palpate {

/// What a finished loop measured.
struct ServoStatistics {
    std::int64_t ticks = 0;
    std::int64_t overruns = 0;       ///< periods skipped
    std::uint64_t lost_records = 0;  ///< ticks that found the ring full
    Histogram tick_ns;               ///< read, contact, force, write
    Histogram wake_latency_ns;
    std::vector<SetupResult> setup;  ///< priority and memory, as granted
};

/// The haptic thread: at 1 kHz reads the device, ticks the model, writes the force, and publishes the result
/// to the visual side (latest value) and to a logger (every value). Model and device must outlive the loop
/// and are its own while it runs.
class ServoLoop {
  public:
    static constexpr std::int64_t period_ns = 1'000'000;

    ServoLoop(HapticModel& model, Device& device, std::size_t ring_capacity = 4096);
    ServoLoop(const ServoLoop&) = delete;
    ServoLoop& operator=(const ServoLoop&) = delete;
    ~ServoLoop();  ///< stops

    /// Starts the thread (SCHED_FIFO and locked memory where permitted) and returns once it is set up. Once
    /// only.
    void start();
    /// Asks the thread to end, waits for it, and leaves the device at zero force.
    void stop();

    /// Runs `ticks` ticks in the calling thread as fast as possible; time advances by one period a tick.
    /// Instead of start(): for tests and for runs that must not depend on the machine.
    void run_virtual(std::int64_t ticks, const std::function<void(const TickResult&)>& sink);

    TripleBuffer<TickResult>& latest() noexcept { return latest_; }  ///< for one reader
    SpscRing<TickResult>& ring() noexcept { return ring_; }          ///< for one consumer; may stay unread
    /// Only while the loop is not running.
    ServoStatistics statistics() const;

  private:
    void run();
    void let_go(PeriodicClock& clock) noexcept;
    void step(double time, std::int64_t wake_latency_ns, std::int64_t overruns) noexcept;

    HapticModel& model_;
    Device& device_;
    TripleBuffer<TickResult> latest_;
    SpscRing<TickResult> ring_;
    TickResult result_;
    ServoStatistics statistics_;
    std::atomic<bool> stop_requested_{false};
    std::atomic<bool> ready_{false};
    std::thread thread_;
};

}  // namespace palpate
