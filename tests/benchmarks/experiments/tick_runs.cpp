// SPDX-License-Identifier: Apache-2.0
#include "tests/benchmarks/experiments/tick_runs.hpp"

#include <algorithm>
#include <optional>

#include "runtime/haptics/collision_loop.hpp"

namespace palpate::bench {
namespace {

constexpr std::int64_t period_ns = 1'000'000;

std::int64_t ticks_of(std::span<const HandPath> paths) {
    return static_cast<std::int64_t>(1000 * std::ranges::max(paths, {}, &HandPath::duration).duration()) + 1;
}

DeviceState state_at(const HandPath& path, std::int64_t tick) {
    DeviceState state;
    state.time = 1e-3 * static_cast<double>(tick);
    Eigen::Map<Eigen::Vector3d>(state.position.data()) = path.at(state.time);
    return state;
}

}  // namespace

TickRun time_ticks(HapticModel& model, std::span<const HandPath> paths, Counted counted, Pace pace) {
    model.reset();
    std::vector<DeviceState> states(paths.size());
    std::vector<TickResult> results(paths.size());
    std::optional<PeriodicClock> clock;
    if (pace == Pace::every_period) clock.emplace(period_ns);
    TickRun run;
    for (run.ticks = 0; run.ticks < ticks_of(paths); ++run.ticks) {
        for (std::size_t t = 0; t < paths.size(); ++t) states[t] = state_at(paths[t], run.ticks);
        if (clock) clock->wait();
        const std::uint64_t spent = nanoseconds_of([&] { model.tick(states, results); });
        std::int64_t rows = 0, pressed = 0;
        for (const TickResult& result : results) {
            rows += result.contact_count;
            pressed += std::ranges::count_if(result.active_contacts(),
                                             [](const Contact& contact) { return contact.force > 0; });
            run.unusual += (result.status & (contacts_cut | contact_unsolved)) != 0;
        }
        run.touching += rows > 0;
        run.rows += static_cast<double>(rows);
        run.pressed += static_cast<double>(pressed);
        if (counted == Counted::all || rows > 0) run.tick.record(spent);
        const std::int64_t next = (run.ticks + 1) * period_ns;
        if (model.scheme() != ContactScheme::continuous &&
            next / CollisionLoop::period_ns > (next - period_ns) / CollisionLoop::period_ns)
            run.detect.record(nanoseconds_of([&] { model.detect(); }));
    }
    const auto touching = static_cast<double>(std::max<std::int64_t>(1, run.touching));
    run.rows /= touching;
    run.pressed /= touching;
    return run;
}

std::int64_t ticks_below(HapticModel& model, const HandPath& path) {
    constexpr double rounding = 1e-6;  // mm
    model.reset();
    TickResult result{};
    std::int64_t below = 0;
    bool clear = false;
    for (std::int64_t tick = 0; tick < ticks_of({&path, 1}); ++tick) {
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

}  // namespace palpate::bench
