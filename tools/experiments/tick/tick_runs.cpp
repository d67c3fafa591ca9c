// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/experiments/tick/tick_runs.hpp"

#include <algorithm>
#include <limits>
#include <set>
#include <utility>

#include "runtime/haptics/collision_loop.hpp"
#include "runtime/haptics/tick_outlet.hpp"

namespace palpate::experiments {
namespace {

using namespace devices;
using namespace haptics;
using namespace realtime;

constexpr std::int64_t period_ns = 1'000'000;
constexpr std::uint64_t unrecorded = std::numeric_limits<std::uint64_t>::max();

std::int64_t ticks_of(std::span<const HandPath> paths) {
    double duration = 0;
    for (const HandPath& path : paths) duration = std::max(duration, path.duration());
    return static_cast<std::int64_t>(1000 * duration) + 1;
}

DeviceState state_at(const HandPath& path, std::int64_t tick) {
    DeviceState state;
    state.time = 1e-3 * static_cast<double>(tick);
    Eigen::Map<Eigen::Vector3d>(state.position.data()) = path.at(state.time);
    return state;
}

// The surface nodes that bear a tick's contacts.
std::size_t loaded_nodes(std::span<const TickResult> results) {
    std::set<std::pair<std::int32_t, std::int32_t>> nodes;  // of a body
    for (const TickResult& result : results)
        for (const Contact& contact : result.active_contacts()) {
            if (!(contact.force > 0)) continue;
            for (std::size_t i = 0; i < 3; ++i)
                if (contact.weights[i] > 0) nodes.insert({contact.body, contact.vertices[i]});
            if (is_of_neighbour(contact)) nodes.insert({contact.other_body, contact.other_vertex});
        }
    return nodes.size();
}

// One pass; `clock` paces it if there is one.
TickRun pass_of(HapticModel& model, std::span<const HandPath> paths, Counted counted, PeriodicClock* clock,
                Shortest& tick, Shortest& detect) {
    model.reset();
    std::vector<DeviceState> states(paths.size());
    std::vector<TickResult> results(paths.size());
    TickOutlet outlet(paths.size());
    TickResult taken;
    TickRun run;
    const std::int64_t ticks = ticks_of(paths);
    for (run.ticks = 0; run.ticks < ticks; ++run.ticks) {
        for (std::size_t t = 0; t < paths.size(); ++t) states[t] = state_at(paths[t], run.ticks);
        if (clock) clock->wait();
        const std::uint64_t spent = nanoseconds_of([&] {
            model.tick(states, results);
            outlet.publish(results);
        });
        while (outlet.ring().pop(taken)) {
        }
        std::int64_t rows = 0, pressed = 0;
        std::uint32_t status = tick_ok;
        for (const TickResult& result : results) {
            rows += result.contact_count;
            pressed += std::ranges::count_if(result.active_contacts(),
                                             [](const Contact& contact) { return contact.force > 0; });
            run.pairs +=
                static_cast<double>(std::ranges::count_if(result.active_contacts(), is_of_neighbour));
            status |= result.status;
        }
        run.cut += (status & contacts_cut) != 0;
        run.unsolved += (status & contact_unsolved) != 0;
        run.touching += rows > 0;
        run.loaded += static_cast<double>(loaded_nodes(results));
        run.pressed += static_cast<double>(pressed);
        const auto step = static_cast<std::size_t>(run.ticks);
        if (counted == Counted::all || rows > 0) tick.record(step, spent);
        const std::int64_t next = (run.ticks + 1) * period_ns;
        if (model.detects() != haptics::Detects::nothing &&
            next / CollisionLoop::published_period_ns >
                (next - period_ns) / CollisionLoop::published_period_ns)
            detect.record(step, nanoseconds_of([&] { model.detect(); }));
    }
    const auto touching = static_cast<double>(std::max<std::int64_t>(1, run.touching));
    run.loaded /= touching;
    run.pressed /= touching;
    run.pairs /= touching;
    return run;
}

TickRun run_of(HapticModel& model, std::span<const HandPath> paths, Counted counted, PeriodicClock* clock,
               int passes) {
    TickRun run;
    Shortest tick, detect;
    for (int pass = 0; pass < passes; ++pass) run = pass_of(model, paths, counted, clock, tick, detect);
    run.tick = tick.histogram();
    run.detect = detect.histogram();
    return run;
}

}  // namespace

void Shortest::record(std::size_t step, std::uint64_t nanoseconds) {
    if (step >= times_.size()) times_.resize(step + 1, unrecorded);
    times_[step] = std::min(times_[step], nanoseconds);
}

Histogram Shortest::histogram() const {
    Histogram histogram;
    for (const std::uint64_t time : times_)
        if (time != unrecorded) histogram.record(time);
    return histogram;
}

TickRun time_ticks(HapticModel& model, std::span<const HandPath> paths, Counted counted) {
    return run_of(model, paths, counted, nullptr, Shortest::passes);
}

TickRun time_paced_ticks(HapticModel& model, std::span<const HandPath> paths, Counted counted) {
    PeriodicClock clock(period_ns);
    return run_of(model, paths, counted, &clock, 1);
}

std::int64_t ticks_below(HapticModel& model, const HandPath& path) {
    constexpr double rounding = 1e-6;  // mm
    model.reset();
    TickResult result{};
    std::int64_t below = 0;
    bool clear = false;
    const std::int64_t ticks = ticks_of({&path, 1});
    for (std::int64_t tick = 0; tick < ticks; ++tick) {
        model.tick(state_at(path, tick), result);
        clear = clear || !(result.status & starts_inside);
        const Eigen::Map<const Eigen::Vector3d> tool(result.tool_position.data());
        below += clear &&
                 model.surface(0).closest_point(tool, model.settings().tool_radius - rounding).has_value();
    }
    return below;
}

Histogram clock_cost() {
    constexpr int readings = 100'000;
    Histogram cost;
    for (int i = 0; i < readings; ++i) cost.record(nanoseconds_of([] {}));
    return cost;
}

BusyThreads::BusyThreads(unsigned count) {
    for (unsigned i = 0; i < count; ++i)
        threads_.emplace_back([](const std::stop_token& stop) {
            while (!stop.stop_requested()) {
            }
        });
}

}  // namespace palpate::experiments
