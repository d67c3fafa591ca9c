// SPDX-License-Identifier: Apache-2.0
#include "runtime/doctor/wake_ups.hpp"

#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <thread>

#include "runtime/realtime/periodic_clock.hpp"
#include "runtime/realtime/servo.hpp"

namespace palpate::doctor {
namespace {

using namespace realtime;

constexpr const char* measured_group = "measured";

double us(std::uint64_t ns) {
    return 1e-3 * static_cast<double>(ns);
}

std::string told(const WakeUps& wake_ups) {
    const Histogram& late = wake_ups.late_ns;
    return fmt::format("woken late by p50 {:.0f}, p99 {:.0f}, p99.9 {:.0f}, max {:.0f} us; {} of {} missed",
                       us(late.percentile(0.5)), us(late.percentile(0.99)), us(late.percentile(0.999)),
                       us(late.max()), wake_ups.missed, late.count());
}

}  // namespace

// A deadline slept through was waited for too: its wait is what the wake-up before the gap was late by, less
// the periods between. Leaving it out would make a machine that sleeps long look better.
void WakeUps::add(std::int64_t late, std::int64_t missed_so_far) noexcept {
    for (std::int64_t gap = 1; missed < missed_so_far; ++missed, ++gap)
        late_ns.record(
            static_cast<std::uint64_t>(std::max<std::int64_t>(0, last_late_ - gap * Servo::period_ns)));
    late_ns.record(static_cast<std::uint64_t>(late));
    last_late_ = late;
}

WakeUps measure_servo(double seconds) {
    WakeUps result;
    PeriodicServo servo;
    servo.start([&](const ServoTick& tick) { result.add(tick.wake_latency_ns, tick.overruns); });
    std::this_thread::sleep_for(std::chrono::duration<double>(seconds));
    servo.stop();
    result.real_time = std::ranges::all_of(servo.setup(), &SetupResult::ok);
    return result;
}

WakeUps measure_without_priority(double seconds) {
    WakeUps result;
    std::thread([&] {
        PeriodicClock clock(Servo::period_ns);
        const std::int64_t end = monotonic_ns() + static_cast<std::int64_t>(1e9 * seconds);
        while (monotonic_ns() < end) {
            const std::int64_t late = clock.wait().latency_ns;
            result.add(late, clock.overruns());
        }
    }).join();
    return result;
}

int rate_held(const WakeUps& wake_ups) {
    for (const int rate : {1000, 500, 250})
        if (1'000'000'000 / rate >
            static_cast<std::int64_t>(wake_ups.late_ns.percentile(0.999)) + tick_budget_ns)
            return rate;
    return 0;
}

Findings wake_up_findings(const WakeUps& servo, const WakeUps& without_priority, Purpose purpose) {
    Findings findings{{"servo", measured_group, Level::ok,
                       (servo.real_time ? "with SCHED_FIFO: " : "SCHED_FIFO refused: ") + told(servo), ""},
                      {"without_priority", measured_group, Level::ok,
                       "for comparison, without: " + told(without_priority), ""}};
    const int rate = rate_held(servo);
    Finding held{"rate", measured_group, Level::ok,
                 fmt::format("holds {} Hz: 99.9 % of wake-ups and {} us for the tick fit its period", rate,
                             tick_budget_ns / 1000),
                 ""};
    if (rate < 1000) {
        held.level = rate == 0 ? lack_of(purpose) : Level::warning;
        if (rate == 0) held.found = "does not hold 250 Hz: 99.9 % of wake-ups do not fit its period";
        held.fix = servo.real_time
                       ? "# mend what is named under 'real time', end other programs and measure again; if\n"
                         "# that is not enough, take Debian's real-time kernel, not in a virtual machine:\n"
                         "sudo apt install linux-image-rt-amd64 && sudo reboot"
                       : "# permit SCHED_FIFO as said under 'real time', fifo, and measure again";
    }
    findings.push_back(std::move(held));
    return findings;
}

}  // namespace palpate::doctor
