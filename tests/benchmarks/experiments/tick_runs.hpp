// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "runtime/devices/hand_path.hpp"
#include "runtime/haptics/haptic_model.hpp"
#include "runtime/realtime/histogram.hpp"
#include "runtime/realtime/periodic_clock.hpp"

namespace palpate::bench {

/// How long `work` takes, the clock's own time included, ns.
template <typename Work>
std::uint64_t nanoseconds_of(Work work) {
    const std::int64_t begin = monotonic_ns();
    work();
    return static_cast<std::uint64_t>(monotonic_ns() - begin);
}

/// Makes the compiler compute a value that nobody reads.
template <typename Value>
void keep(const Value& value) {
    asm volatile("" : : "r,m"(value) : "memory");
}

/// What the ticks along a path took.
struct TickRun {
    Histogram tick;    ///< HapticModel::tick(), ns
    Histogram detect;  ///< HapticModel::detect(), ns: of the published schemes, 30 in a virtual second
    std::int64_t ticks = 0, touching = 0;
    std::int64_t unusual = 0;      ///< with TickStatus contacts_cut or contact_unsolved
    double rows = 0, pressed = 0;  ///< mean contact points of touching ticks, and those with force
};

enum class Counted { all, touching };            ///< which ticks the histogram holds
enum class Pace { back_to_back, every_period };  ///< every 1 ms, as a servo loop

/// Moves one tool along each path, from a reset on.
TickRun time_ticks(HapticModel& model, std::span<const HandPath> paths, Counted counted,
                   Pace pace = Pace::back_to_back);

/// Of the ticks after the tool was first clear, those with its surface more than 1e-6 mm below the one rigid
/// body's. `continuous` only.
std::int64_t ticks_below(HapticModel& model, const HandPath& path);

/// What reading the clock twice costs, ns.
Histogram clock_cost();

/// Threads that do nothing but keep cores busy, until destroyed.
class BusyThreads {
  public:
    explicit BusyThreads(unsigned count);

  private:
    std::vector<std::jthread> threads_;
};

/// A row of the table and of the JSON.
struct TickRow {
    std::string group, name;
    Histogram times;                       ///< ns
    TickRun run;                           ///< ticks 0: a query or a loop, not a run of ticks
    double limit_p50 = 0, limit_p999 = 0;  ///< us; 0: none
};

}  // namespace palpate::bench
