// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/experiments/faults.hpp"

#include <array>
#include <fmt/format.h>

#include "formats/asset/asset.hpp"
#include "tools/experiments/fault_run.hpp"

namespace palpate::experiments {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::int64_t visit_ticks = 600'000;  // ten minutes at one place
constexpr std::array<std::string_view, 3> methods_in_turn{"continuous", "twice", "twice-renewed"};
constexpr std::string_view explanation =
    "Virtual time at 1 kHz: a simulated Touch, whose motors stay cool, in a hand that gives way (0.3 N/mm) "
    "pushes, slides and leaves "
    "at a "
    "random body of the case, a new path every ten minutes. Faults, 1 ms to 2 s long, follow one another "
    "after 1.2 "
    "to 20 s. `above` counts ticks with more than the device's or the case's largest force, and steps "
    "beyond the "
    "slew limit; `not gone` ticks with any force 20 ms after a fault began, while it lasts; `missed` faults "
    "that "
    "were not reported in their first tick, `unexpected` reports without a fault. Visits are with the "
    "methods "
    "`continuous`, `twice` and `twice-renewed` in turn.\n\n"
    "| case | virtual time, h | faults | reported | missed | unexpected | above limit | above slew | not "
    "finite | not "
    "gone | strongest, N | largest step, N | growth while coming back, N |\n"
    "|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n";

Json json_of(const std::string& name, const FaultRun& run) {
    return {{"case", name},
            {"ticks", run.ticks},
            {"ticks_with_force", run.pressing},
            {"injected", run.injected},
            {"reported", run.reported},
            {"missed", run.missed},
            {"unexpected", run.unexpected},
            {"above_limit_ticks", run.above_limit},
            {"above_slew_ticks", run.above_slew},
            {"not_finite_ticks", run.not_finite},
            {"not_gone_ticks", run.not_gone},
            {"strongest_n", run.strongest},
            {"largest_step_n", run.largest_step},
            {"largest_growth_n", run.largest_growth}};
}

std::string row_of(const std::string& name, const FaultRun& run) {
    std::int64_t injected = 0;
    for (const auto& [kind, count] : run.injected) injected += count;
    return fmt::format("| {} | {:.1f} | {} | {} | {} | {} | {} | {} | {} | {} | {:.3f} | {:.3f} | {:.4f} |\n",
                       name, static_cast<double>(run.ticks) / 3.6e6, injected, run.reported, run.missed,
                       run.unexpected, run.above_limit, run.above_slew, run.not_finite, run.not_gone,
                       run.strongest, run.largest_step, run.largest_growth);
}

}  // namespace

Findings faults(const Options& options, cli::Session& session) {
    if (options.cases.empty()) throw UsageError({"--case", "none is given", "one asset or more", ""});
    const double seconds = options.seconds > 0 ? options.seconds : 86'400;
    const auto share = static_cast<std::int64_t>(1000 * seconds / static_cast<double>(options.cases.size()));
    devices::DeviceModel device = devices::find_device_model("touch");
    device.max_continuous_force = 0;  // never warm by itself: what is reported is what was made to happen
    Findings findings;
    Json runs = Json::array();
    std::string rows;
    std::mt19937_64 random(options.seed);
    for (const auto& file : options.cases) {
        const Case patient_case = asset::read_asset(file);
        FaultRun whole;
        for (std::size_t visit = 0; whole.ticks < share; ++visit) {
            session.progress.step(patient_case.name,
                                  static_cast<double>(whole.ticks) / static_cast<double>(share));
            const std::int64_t ticks = std::min(visit_ticks, share - whole.ticks);
            whole.add(run_with_faults(patient_case, methods_in_turn[visit % methods_in_turn.size()], device,
                                      draw_injections(ticks, random), ticks, random));
        }
        runs.push_back(json_of(patient_case.name, whole));
        rows += row_of(patient_case.name, whole);
    }
    session.progress.finish();
    findings.result = {{"device", device.name}, {"seed", options.seed}, {"runs", runs}};
    findings.table = std::string(explanation) + rows;
    return findings;
}

}  // namespace palpate::experiments
