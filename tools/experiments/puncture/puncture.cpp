// SPDX-License-Identifier: GPL-3.0-or-later
//
// What counts as a puncture was fixed before anything was measured, is the same for every scheme, and is
// printed above the tables (`definition` below): the force at the end of a press decides, not where a scheme
// believes the tool to be. Neither it nor any setting was adjusted to published counts.
#include "tools/experiments/puncture/puncture.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <memory>

#include "formats/drawing/chart.hpp"
#include "tools/experiments/puncture/approach_run.hpp"
#include "tools/experiments/puncture/puncture_groups.hpp"
#include "tools/experiments/puncture/synchroniser.hpp"
#include "tools/experiments/puncture/wall_map.hpp"
#include "tools/experiments/rigid_case.hpp"
#include "tools/experiments/statistics.hpp"
#include "tools/meshing/files/mesh_files.hpp"

namespace palpate::experiments {
namespace {

using namespace devices;
using namespace haptics;
using drawing::Chart;
using drawing::Series;

using Json = nlohmann::ordered_json;

constexpr std::size_t per_speed = 100;
constexpr double slowest_group = 131, fastest_group = 157;  // mm/s, as published
constexpr std::array speeds{50.0, 100.0, 145.0, 200.0, 300.0, 500.0, 700.0, 1000.0};

constexpr auto definition = R"(## What counts as a puncture

A hand (spring 0.3 N/mm, damper 2 N s/m) moves the simulated device `{device}` straight along the inward normal of
a random place on the outer side of the bone, from {run_up:g} mm before the surface to {stroke:g} mm behind it, and
presses there for {press:g} s. The approach is a **puncture** if the force against it, averaged over the last
{judged:g} ms, is less than half of what an unbroken wall would hold the hand back with ({half:.2f} of {whole:.2f} N:
coupling and hand in series over the stroke). It counts as **pulled** if the tool was ever drawn inwards by more than
0.1 N. This was fixed before measuring and is the same for all schemes. Every scheme makes the same approaches, with
the same random phase of the 30 Hz detection loop. Places are uniform in area wherever a tool reaches the head from
outside and the bone around is not an edge (within 6 mm no steeper than 34 degrees); thickness is not asked for.

)";

// What the experiment works on.
struct Bench {
    Case bone;
    std::vector<std::unique_ptr<HapticModel>> models;  // by scheme
    const DeviceModel& device = find_device_model("desktop");
    std::mt19937_64 random;

    HapticModel& model(std::size_t scheme) { return *models[scheme]; }
    double coupling() const { return models[0]->coupling(); }
    bool punctured(const Outcome& outcome) const { return is_puncture(outcome, coupling()); }

    std::vector<Approach> draw(std::size_t count, const std::function<double(std::size_t)>& speed_of) {
        std::uniform_real_distribution<double> unit(0, 1);
        std::vector<Approach> approaches;
        for (Place& place : draw_places(bone.rigid_bodies[0].surface, models[0]->surface(0),
                                        approach_settings.tool_radius, count, random))
            approaches.push_back({std::move(place), speed_of(approaches.size()), unit(random)});
        return approaches;
    }
    std::vector<Outcome> run(std::size_t scheme, const std::vector<Approach>& approaches) {
        std::vector<Outcome> outcomes;
        for (const Approach& approach : approaches)
            outcomes.push_back(run_approach(model(scheme), device, approach, false));
        return outcomes;
    }
};

Bench bench_of(const Options& options) {
    if (options.surfaces.size() != 1)
        throw UsageError({"--surface", std::to_string(options.surfaces.size()) + " given",
                          "triangles of one bone (.vtp)", ""});
    const std::filesystem::path& file = options.surfaces.front();
    Bench bench{.bone = rigid_case(file.stem().string(), meshing::read_surface(file), approach_settings),
                .models = {},
                .random = std::mt19937_64(options.seed)};
    for (const std::string_view scheme : schemes) {
        bench.models.push_back(std::make_unique<HapticModel>(bench.bone, scheme));
        const DynamicDevice device(bench.device, {}, HandPath({{0, Eigen::Vector3d::Zero()}}));
        const DeviceLimits limits = device.limits();
        bench.models.back()->couple_to({&limits, 1});
    }
    return bench;
}

GroupRun run_groups(Bench& bench) {
    std::uniform_real_distribution<double> speed(slowest_group, fastest_group);
    std::array<double, puncture_groups> group_speeds{};
    for (double& one : group_speeds) one = speed(bench.random);
    GroupRun run{
        .approaches = bench.draw(puncture_groups * approaches_per_group,
                                 [&](std::size_t i) { return group_speeds[i / approaches_per_group]; }),
        .outcomes = {},
        .coupling = bench.coupling()};
    for (std::size_t scheme = 0; scheme < run.outcomes.size(); ++scheme)
        run.outcomes[scheme] = bench.run(scheme, run.approaches);
    return run;
}

// The first that `single` punctures.
const Approach& shown_approach(const GroupRun& run) {
    const auto first = std::ranges::find_if(
        run.outcomes[0], [&](const Outcome& outcome) { return is_puncture(outcome, run.coupling); });
    const auto index = first == run.outcomes[0].end() ? 0 : first - run.outcomes[0].begin();
    return run.approaches[index];
}

const Place& thickest(const GroupRun& run) {
    return std::ranges::max_element(run.approaches, {}, [](const Approach& a) { return a.place.thickness; })
        ->place;
}

// Punctures by speed, for every scheme, at the same places.
Chart speed_chart(std::string& table, Json& result, Bench& bench) {
    Chart chart{.title = fmt::format("Punctures in {} approaches", per_speed),
                .x_label = "speed of the hand [mm/s]",
                .y_label = "punctures [%]"};
    table += fmt::format("\n## By speed\n\nPunctures in the same {} approaches at each speed.\n\n{}",
                         per_speed, scheme_columns("mm/s"));
    for (const std::string_view name : schemes) chart.series.push_back({.name = std::string(name)});
    auto approaches = bench.draw(per_speed, [](std::size_t) { return speeds.front(); });
    for (const double speed : speeds) {
        for (Approach& approach : approaches) approach.speed = speed;
        table += fmt::format("| {:g} |", speed);
        for (std::size_t scheme = 0; scheme < chart.series.size(); ++scheme) {
            const auto outcomes = bench.run(scheme, approaches);
            const auto count = std::ranges::count_if(
                outcomes, [&](const Outcome& outcome) { return bench.punctured(outcome); });
            table += fmt::format(" {} |", count);
            chart.series[scheme].x.push_back(speed);
            chart.series[scheme].y.push_back(100.0 * static_cast<double>(count) / per_speed);
            result["by_speed"][std::string(schemes[scheme])].push_back({speed, count});
        }
        table += "\n";
    }
    return chart;
}

// Force and depth of one approach, for every scheme.
std::array<Chart, 2> curves(Bench& bench, const Approach& approach) {
    const std::string title =
        fmt::format("{:.0f} mm/s onto {:.1f} mm of bone: ", approach.speed, approach.place.thickness);
    std::array<Chart, 2> charts{Chart{.title = title + "force against the approach",
                                      .x_label = "time since the hand passed the surface [s]",
                                      .y_label = "N"},
                                Chart{.title = title + "depth of the tip",
                                      .x_label = "time since the hand passed the surface [s]",
                                      .y_label = "mm"}};
    for (const std::string_view name : schemes) {
        Series force{.name = std::string(name)}, depth{.name = std::string(name)};
        const std::size_t scheme = charts[0].series.size();
        run_approach(bench.model(scheme), bench.device, approach, false, [&](const ApproachTick& tick) {
            if (tick.depth < -5) return;
            force.x.push_back(tick.time - Approach::run_up / approach.speed);
            force.y.push_back(tick.force);
            depth.x.push_back(force.x.back());
            depth.y.push_back(tick.depth);
        });
        charts[0].series.push_back(std::move(force));
        charts[1].series.push_back(std::move(depth));
    }
    return charts;
}

}  // namespace

Findings puncture(const Options& options, cli::Session& session) {
    session.progress.step("reading", 0);
    Bench bench = bench_of(options);
    const double whole = unbroken_force(bench.coupling());
    Findings findings;
    findings.table =
        "# Punctures\n\n" +
        fmt::format(fmt::runtime(definition), fmt::arg("device", bench.device.name),
                    fmt::arg("run_up", Approach::run_up), fmt::arg("stroke", Approach::stroke),
                    fmt::arg("press", Approach::press_s), fmt::arg("judged", 1e3 * Approach::judged_s),
                    fmt::arg("half", whole / 2), fmt::arg("whole", whole));

    session.progress.step("groups", 0.05);
    const GroupRun run = run_groups(bench);
    findings.result["groups"] = add_group_tables(findings.table, run);
    findings.result["reasons"] = add_reasons(findings.table, run);

    session.progress.step("walls", 0.1);
    const WallMap map = map_walls(bench.device);
    findings.result["walls"] = add_wall_tables(findings.table, map);

    session.progress.step("synchroniser", 0.5);
    const SynchroniserRun synchronised = compare_synchronisers(bench.bone, thickest(run), bench.device);
    findings.result["synchroniser"] = add_synchroniser_table(findings.table, synchronised);

    session.progress.step("speeds", 0.7);
    const Chart by_speed = speed_chart(findings.table, findings.result, bench);

    const auto [force, depth] = curves(bench, shown_approach(run));
    findings.pictures.emplace_back("puncture_by_wall", drawing::charts_svg(wall_charts(map)));
    findings.pictures.emplace_back("synchroniser", drawing::charts_svg(synchronised.charts));
    findings.pictures.emplace_back("puncture_by_speed", drawing::charts_svg({by_speed}));
    findings.pictures.emplace_back("puncture_curves", drawing::charts_svg({force, depth}));
    return findings;
}

}  // namespace palpate::experiments
