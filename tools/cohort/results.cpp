// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cohort/results.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <numeric>

#include "formats/records/felt_region.hpp"

namespace palpate::cohort {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<Figure, 11> all_figures{{
    {"volume_ml", "Volume", "ml"},
    {"tetrahedra", "Tetrahedra", ""},
    {"contact_nodes", "Nodes that can be touched", ""},
    {"min_dihedral_deg", "Smallest dihedral angle", "°"},
    {"residual", "Certificate's residual", ""},
    {"peak_force_n", "Peak force of the press", "N"},
    {"felt_regions", "Regions that can be felt", ""},
    {"contrast_percent", "Contrast of the faintest region", "%"},
    {"asset_mb", "Asset", "MB"},
    {"seconds", "Time, all stages", "s"},
    {"peak_memory_mb", "Peak memory", "MB"},
}};

// The figures of the finished stages; sums over bodies, but for angles, residuals and contrasts, of which the
// worst.
Json figures_of(const std::vector<case_builder::Stage>& stages, const std::vector<StageState>& states) {
    Json found = Json::object();
    const auto combine = [&](const char* key, double value, auto&& operation) {
        found[key] = found.contains(key) ? operation(found[key].get<double>(), value) : value;
    };
    const auto smaller = [](double a, double b) { return std::min(a, b); };
    const auto larger = [](double a, double b) { return std::max(a, b); };
    for (std::size_t i = 0; i < states.size(); ++i) {
        if (!states[i].record) continue;
        const case_builder::StageRecord& record = *states[i].record;
        const Json& result = record.result;
        combine("seconds", record.seconds, std::plus<>());
        combine("peak_memory_mb", static_cast<double>(record.peak_memory_bytes) / 1e6, larger);
        if (stages[i].command == "mesh") {
            for (const Json& region : result.value("regions", Json::array()))
                combine("volume_ml", region.at("volume_mm3").get<double>() / 1000, std::plus<>());
            combine("tetrahedra", result.at("tetrahedra"), std::plus<>());
            combine("min_dihedral_deg", result.at("min_dihedral_deg"), smaller);
        } else if (stages[i].command == "condense") {
            combine("contact_nodes", result.at("contact_nodes"), std::plus<>());
            combine("residual", result.at("certificate").at("residual"), larger);
        } else if (stages[i].command == "pack") {
            found["asset_mb"] = result.at("bytes").get<double>() / 1e6;
            for (const Json& region : result.value("felt", Json::array())) {
                combine("felt_regions", region.at("verdict") == verdict_word(FeltVerdict::felt) ? 1 : 0,
                        std::plus<>());
                combine("contrast_percent", std::abs(region.at("contrast_percent").get<double>()), smaller);
            }
        } else if (stages[i].command == "touch") {
            found["peak_force_n"] = result.at("force_peak_n");
        }
    }
    return found;
}

std::string on_one_line(std::string text) {
    while (!text.empty() && text.back() == '\n') text.pop_back();
    std::ranges::replace(text, '\n', ' ');
    std::ranges::replace(text, '\t', ' ');
    return text;
}

const char* name_of(StageState::Kind kind) {
    switch (kind) {
        case StageState::Kind::finished:
            return "finished";
        case StageState::Kind::failed:
            return "failed";
        case StageState::Kind::waiting:
            return "waiting";
        default:
            return "to do";
    }
}

double median(std::vector<double> values) {
    std::ranges::sort(values);
    const std::size_t n = values.size();
    return (values[(n - 1) / 2] + values[n / 2]) / 2;
}

}  // namespace

std::span<const Figure> figures() {
    return all_figures;
}

const char* name_of(Outcome outcome) {
    switch (outcome) {
        case Outcome::built:
            return "built";
        case Outcome::failed:
            return "failed";
        default:
            return "unfinished";
    }
}

PatientResult result_of(const PatientBuild& build, std::vector<StageState> states) {
    PatientResult result;
    result.patient = build.patient.name;
    result.paths = build.paths;
    for (const case_builder::Stage& stage : build.stages) result.stages.push_back(stage.name);
    const Json found = figures_of(build.stages, states);
    for (const Figure& figure : all_figures)
        result.figures.push_back(found.contains(figure.key) ? std::optional(found[figure.key].get<double>())
                                                            : std::nullopt);
    const auto failed =
        std::ranges::find_if(states, [](const StageState& state) { return state.failure.has_value(); });
    if (!build.patient.mistake.empty()) {
        result.outcome = Outcome::failed;
        result.said = build.patient.mistake;
    } else if (failed != states.end()) {
        result.outcome = Outcome::failed;
        result.failed_stage = result.stages[static_cast<std::size_t>(failed - states.begin())];
        result.said = failed->failure->said;
    } else if (std::ranges::all_of(states,
                                   [](const StageState& state) { return state.record.has_value(); })) {
        result.outcome = Outcome::built;
    }
    result.states = std::move(states);
    return result;
}

Json status_json(const PatientResult& result) {
    Json stages = Json::array(), known = Json::object();
    for (std::size_t i = 0; i < result.stages.size(); ++i) {
        const StageState& state = result.states[i];
        Json row{{"stage", result.stages[i]}, {"status", name_of(state.kind)}};
        if (state.record) {
            row["seconds"] = state.record->seconds;
            row["peak_memory_mb"] = static_cast<double>(state.record->peak_memory_bytes) / 1e6;
        }
        if (state.failure) {
            row["exit_code"] = state.failure->exit_code;
            row["said"] = state.failure->said;
        }
        stages.push_back(std::move(row));
    }
    for (std::size_t i = 0; i < all_figures.size(); ++i)
        if (result.figures[i]) known[all_figures[i].key] = *result.figures[i];
    Json json{
        {"schema", "palpate.patient/1"}, {"patient", result.patient}, {"status", name_of(result.outcome)}};
    if (!result.failed_stage.empty()) json["failed_stage"] = result.failed_stage;
    if (!result.said.empty()) json["said"] = result.said;
    if (result.outcome == Outcome::built) {
        json["asset"] = result.paths.asset.filename().string();
        json["report"] = result.paths.report.filename().string();
    }
    json["figures"] = known;
    json["stages"] = stages;
    return json;
}

std::string results_table(std::span<const PatientResult> results) {
    std::string table = "patient\tstatus\tfailed_stage";
    for (const Figure& figure : all_figures) table += fmt::format("\t{}", figure.key);
    table += "\tsaid\n";
    for (const PatientResult& result : results) {
        table += fmt::format("{}\t{}\t{}", on_one_line(result.patient), name_of(result.outcome),
                             result.failed_stage);
        for (const auto& value : result.figures) table += value ? fmt::format("\t{:.6g}", *value) : "\t";
        table += "\t" + on_one_line(result.said) + "\n";
    }
    return table;
}

std::string stages_table(std::span<const PatientResult> results) {
    std::string table = "patient\tstage\tseconds\tpeak_memory_mb\n";
    for (const PatientResult& result : results)
        for (std::size_t i = 0; i < result.stages.size(); ++i)
            if (const auto& record = result.states[i].record)
                table += fmt::format("{}\t{}\t{:.3f}\t{:.0f}\n", result.patient, result.stages[i],
                                     record->seconds, static_cast<double>(record->peak_memory_bytes) / 1e6);
    return table;
}

std::string summary_text(std::span<const PatientResult> results) {
    std::string text;
    const auto count = [&](Outcome outcome) {
        return std::ranges::count(results, outcome, &PatientResult::outcome);
    };
    for (const PatientResult& result : results) {
        if (result.outcome == Outcome::built) continue;
        text += fmt::format("{}  {}", on_one_line(result.patient), name_of(result.outcome));
        if (!result.failed_stage.empty()) text += " at " + result.failed_stage;
        if (!result.said.empty()) text += ": " + on_one_line(result.said);
        text += '\n';
    }
    return text + fmt::format("{} of {} patients built, {} failed, {} unfinished\n", count(Outcome::built),
                              results.size(), count(Outcome::failed), count(Outcome::unfinished));
}

std::vector<bool> outliers(std::span<const std::optional<double>> values) {
    std::vector<double> known;
    for (const auto& value : values)
        if (value) known.push_back(*value);
    std::vector<bool> apart(values.size(), false);
    if (known.size() < 5) return apart;
    const double centre = median(known);
    for (double& value : known) value = std::abs(value - centre);
    const double spread = median(known);
    for (std::size_t i = 0; i < values.size(); ++i)
        apart[i] = values[i] && spread > 0 && 0.6745 * std::abs(*values[i] - centre) > 3.5 * spread;
    return apart;
}

}  // namespace palpate::cohort
