// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cohort/plan.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace palpate::cohort {
namespace {

using Json = nlohmann::ordered_json;

Json stages_json(const PatientBuild& build, const std::vector<bool>& to_do) {
    Json stages = Json::object();
    for (std::size_t i = 0; i < to_do.size(); ++i) {
        if (!to_do[i]) continue;
        Json after = Json::array();
        for (const std::size_t before : stages_before(build, i))
            if (to_do[before]) after.push_back(file_name_of(build.stages[before].name));
        stages[file_name_of(build.stages[i].name)] = {
            {"stage", build.stages[i].name}, {"command", build.stages[i].command}, {"after", after}};
    }
    return stages;
}

}  // namespace

std::vector<bool> stages_to_do(const PatientBuild& build, const std::vector<StageState>& states) {
    std::vector<bool> in_vain, to_do;
    for (std::size_t i = 0; i < states.size(); ++i) {
        const auto before = stages_before(build, i);
        in_vain.push_back((states[i].failure && is_lasting(*states[i].failure)) ||
                          std::ranges::any_of(before, [&](std::size_t j) { return in_vain[j]; }));
        to_do.push_back(states[i].kind != StageState::Kind::finished && !in_vain[i]);
    }
    return to_do;
}

Json plan_of(std::span<const PatientBuild> builds, std::span<const std::vector<StageState>> states,
             const CohortFolder& folder, const std::filesystem::path& table_folder,
             const std::filesystem::path& programs) {
    Json patients = Json::object();
    for (std::size_t i = 0; i < builds.size(); ++i) {
        Json stages = stages_json(builds[i], stages_to_do(builds[i], states[i]));
        if (stages.empty()) continue;
        const std::string& name = builds[i].patient.name;
        patients[name] = {{"request", folder.request_of(name).string()}, {"stages", std::move(stages)}};
    }
    return {{"program", (programs / "palpate").string()},
            {"table_folder", table_folder.string()},
            {"logs", (folder.root / "logs").string()},
            {"patients", std::move(patients)}};
}

Json request_of(const PatientBuild& build) {
    Json settings = Json::array();
    for (const case_builder::Override& override : build.patient.overrides)
        settings.push_back(override.key + "=" + override.value);
    Json request{{"case", build.patient.case_path.string()},
                 {"output", build.paths.asset.string()},
                 {"virtual_clock", true}};
    if (!settings.empty()) request["set"] = settings;
    return request;
}

}  // namespace palpate::cohort
