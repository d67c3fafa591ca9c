// SPDX-License-Identifier: GPL-3.0-or-later
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

namespace palpate::experiments {

/// How long `work` takes, the clock's own time included, ns.
template <typename Work>
std::uint64_t nanoseconds_of(Work work) {
    const std::int64_t begin = realtime::monotonic_ns();
    work();
    return static_cast<std::uint64_t>(realtime::monotonic_ns() - begin);
}

/// Makes the compiler compute a value that nobody reads.
template <typename Value>
void keep(const Value& value) {
    asm volatile("" : : "r,m"(value) : "memory");
}

/// The shortest of several times of each step of a work that repeats itself exactly: what other processes
/// take in between drops out, what the work itself takes stays.
class Shortest {
  public:
    static constexpr int passes = 3;
    void record(std::size_t step, std::uint64_t nanoseconds);
    realtime::Histogram histogram() const;  ///< of the steps that were recorded

  private:
    std::vector<std::uint64_t> times_;
};

/// What the ticks along a path took. As in a servo loop, a tick has handed its results over when it ends.
struct TickRun {
    realtime::Histogram tick;    ///< HapticModel::tick() and TickOutlet::publish(), ns
    realtime::Histogram detect;  ///< HapticModel::detect(), ns: of what needs it, 30 in a virtual second
    std::int64_t ticks = 0, touching = 0;
    std::int64_t cut = 0, unsolved = 0;  ///< with TickStatus contacts_cut, contact_unsolved
    double pressed = 0, loaded = 0;      ///< mean contact points with force of touching ticks; surface nodes
    double pairs = 0;                    ///< of these, between two bodies
};

enum class Counted { all, touching };  ///< which ticks the histogram holds

/// Moves one tool along each path, from a reset on, back to back; of each tick the shortest of several
/// passes counts.
TickRun time_ticks(haptics::HapticModel& model, std::span<const devices::HandPath> paths, Counted counted);

/// The same once, a tick every 1 ms, as a servo loop has it.
TickRun time_paced_ticks(haptics::HapticModel& model, std::span<const devices::HandPath> paths,
                         Counted counted);

/// Of the ticks after the tool was first clear, those with its surface more than 1e-6 mm below the one rigid
/// body's. `continuous` only.
std::int64_t ticks_below(haptics::HapticModel& model, const devices::HandPath& path);

/// What reading the clock twice costs, ns.
realtime::Histogram clock_cost();

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
    realtime::Histogram times;             ///< ns
    TickRun run;                           ///< ticks 0: a query or a loop, not a run of ticks
    double limit_p50 = 0, limit_p999 = 0;  ///< us; 0: none
};

}  // namespace palpate::experiments
