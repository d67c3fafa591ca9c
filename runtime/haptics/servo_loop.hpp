// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "runtime/haptics/collision_loop.hpp"
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

/// The haptic thread: at 1 kHz reads the devices, ticks the model, writes the forces, and publishes the
/// results to the visual side (latest value) and to a logger (every value); for the published schemes also
/// the collision loop at 30 Hz. Model and devices must outlive the loop and are its own while it runs.
class ServoLoop {
  public:
    static constexpr std::int64_t period_ns = 1'000'000;

    /// Takes one device for each of the model's tools and couples the model to what all of them bear. Throws
    /// InvalidInput if there are not as many.
    ServoLoop(HapticModel& model, std::span<Device* const> devices, std::size_t ring_capacity = 4096);
    ServoLoop(HapticModel& model, Device& device, std::size_t ring_capacity = 4096)
        : ServoLoop(model, std::array{&device}, ring_capacity) {}
    ServoLoop(const ServoLoop&) = delete;
    ServoLoop& operator=(const ServoLoop&) = delete;
    ~ServoLoop();  ///< stops

    /// Starts the thread (SCHED_FIFO and locked memory where permitted) and returns once it is set up. Once
    /// only.
    void start();
    /// Asks the threads to end, waits for them, and leaves the devices at zero force.
    void stop();

    /// Runs `ticks` ticks in the calling thread as fast as possible; time advances by one period a tick, and
    /// published schemes detect 30 times a second of it. `sink` gets each tool's result of each tick. Instead
    /// of start(): for tests and for runs that must not depend on the machine.
    void run_virtual(std::int64_t ticks, const std::function<void(const TickResult&)>& sink);

    /// The latest result of one tool, for one reader.
    TripleBuffer<TickResult>& latest(std::size_t tool = 0) noexcept { return *latest_[tool]; }
    /// The results of all tools, for one consumer; may stay unread.
    SpscRing<TickResult>& ring() noexcept { return ring_; }
    /// Only while the loop is not running.
    ServoStatistics statistics() const;

  private:
    void run();
    void let_go(PeriodicClock& clock) noexcept;
    void write_forces() noexcept;
    void release() noexcept;
    void step(double time, std::int64_t wake_latency_ns, std::int64_t overruns) noexcept;

    HapticModel& model_;
    std::vector<Device*> devices_;
    std::vector<std::unique_ptr<TripleBuffer<TickResult>>> latest_;  // one per tool, as are the next two
    std::vector<DeviceState> states_;
    std::vector<TickResult> results_;
    SpscRing<TickResult> ring_;
    CollisionLoop collision_;
    ServoStatistics statistics_;
    std::atomic<bool> stop_requested_{false};
    std::atomic<bool> ready_{false};
    std::thread thread_;
};

}  // namespace palpate
