// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/records/tick_result.hpp"
#include "runtime/haptics/collision_loop.hpp"
#include "runtime/haptics/haptic_model.hpp"
#include "runtime/haptics/tick_outlet.hpp"
#include "runtime/realtime/device.hpp"
#include "runtime/realtime/histogram.hpp"
#include "runtime/realtime/servo.hpp"
#include "runtime/realtime/servo_callbacks.hpp"

namespace palpate::haptics {

/// What a finished loop measured.
struct ServoStatistics {
    std::int64_t ticks = 0;
    std::int64_t overruns = 0;       ///< periods skipped
    std::uint64_t lost_records = 0;  ///< ticks that found the ring full
    realtime::Histogram tick_ns;     ///< read, contact, force, write, and the results handed over
    realtime::Histogram wake_latency_ns;
    std::vector<realtime::SetupResult> setup;  ///< priority and memory, as granted
};

/// The haptic loop: at 1 kHz reads the devices, ticks the model, writes the forces, and publishes the results
/// to the visual side (latest value) and to a logger (every value); for a contact method that
/// detects also the collision loop. Model, devices and servo must outlive the loop and are its own
/// while it runs.
class ServoLoop {
  public:
    static constexpr std::int64_t period_ns = realtime::Servo::period_ns;
    /// So many periods late, or skipped at once, are the fault tick_late.
    static constexpr std::int64_t late_periods = 10;
    /// So long after the last visual_beat() is the fault visual_stopped: a window is dead then, not slow, as
    /// one of 3840 by 2160 pixels is, of which software draws two or three a second. Force needs none of it.
    static constexpr std::int64_t visual_patience_ns = 2'000'000'000;

    /// Takes one device for each of the model's tools and couples the model to what all of them bear. Ticks
    /// in `servo`, or if that is null in a PeriodicServo of its own. Throws InvalidInput if there are not as
    /// many devices.
    ServoLoop(HapticModel& model, std::span<realtime::Device* const> devices,
              realtime::Servo* servo = nullptr, std::size_t ring_capacity = 4096);
    ServoLoop(HapticModel& model, realtime::Device& device, std::size_t ring_capacity = 4096)
        : ServoLoop(model, std::array{&device}, nullptr, ring_capacity) {}
    ServoLoop(const ServoLoop&) = delete;
    ServoLoop& operator=(const ServoLoop&) = delete;
    ~ServoLoop();  ///< stops

    /// Locks memory where permitted, starts the servo and returns once it is set up. Once only.
    void start();
    /// Takes the forces to zero as for a fault, then ends the servo. A servo that does not tick any more is
    /// not waited for longer than a quarter of a second.
    void stop();

    /// While it runs: goes on with another model, coupled to the same devices. Takes the forces to zero as
    /// for a fault, changes over between two ticks and returns; ticks are numbered on. Contact starts anew,
    /// and the force comes back over half a second. False, and nothing is changed,
    /// if the servo has not come so far within a quarter of a second. Throws InvalidInput if the model has
    /// not as many tools.
    bool change_model(HapticModel& model);

    /// Runs `ticks` ticks in the calling thread as fast as possible, the k-th, from 1 on, at `wake(k)`; by
    /// default one period after the other. A method that detects does so as often as its collision loop would
    /// in that time. `sink` gets each tool's result of each tick. Instead of start(): for tests and for runs
    /// that must not depend on the machine.
    void run_virtual(std::int64_t ticks, const std::function<void(const TickResult&)>& sink,
                     const std::function<realtime::ServoTick(std::int64_t)>& wake = in_time);
    /// A wake-up that is never late.
    static realtime::ServoTick in_time(std::int64_t tick) noexcept {
        return {1e-9 * static_cast<double>(tick * period_ns), 0, 0};
    }

    /// Any thread: says that `fault` is there, or gone again. The force goes to zero meanwhile.
    void set_fault(Fault fault, bool there) noexcept;
    /// The visual side, once a frame: says that it still draws. Watched from the first call on.
    void visual_beat() noexcept;
    /// Runs other threads' functions between two ticks.
    realtime::ServoCallbacks& callbacks() noexcept { return callbacks_; }

    /// The latest result of one tool, for one reader.
    realtime::TripleBuffer<TickResult>& latest(std::size_t tool = 0) noexcept { return outlet_.latest(tool); }
    /// The results of all tools, for one consumer; may stay unread.
    realtime::SpscRing<TickResult>& ring() noexcept { return outlet_.ring(); }
    /// Only while the loop is not running.
    ServoStatistics statistics() const;

  private:
    void step(const realtime::ServoTick& wake) noexcept;
    std::uint32_t faults_of(const realtime::ServoTick& wake, std::int64_t now_ns) noexcept;
    void count_stopping() noexcept;
    void change_over(HapticModel& next) noexcept;
    void couple(HapticModel& model) const;
    void detect_beside(Detects detects);

    std::atomic<HapticModel*> model_;
    std::atomic<HapticModel*> next_model_{nullptr};  // that change_model() waits for
    std::vector<realtime::Device*> devices_;
    realtime::PeriodicServo own_servo_;
    realtime::Servo& servo_;
    std::vector<realtime::DeviceState> states_;  // one per tool, as are the results
    std::vector<TickResult> results_;
    TickOutlet outlet_;
    std::optional<CollisionLoop> collision_;  // where the model detects
    realtime::ServoCallbacks callbacks_;
    ServoStatistics statistics_;
    std::atomic<std::uint32_t> faults_{no_fault};  // that other threads have told of
    std::atomic<std::int64_t> visual_beat_ns_{0};  // 0: never
    std::atomic<bool> stopping_{false}, released_{false};
    int ticks_stopping_ = 0, ticks_changing_ = 0;  // the servo's, as is the next
    bool model_is_new_ = false;                    // since the last tick
    Detects detected_ = Detects::nothing;          // by the collision loop
    bool running_ = false;
};

}  // namespace palpate::haptics
