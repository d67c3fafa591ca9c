// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cohort/patient_build.hpp"

#include <algorithm>

#include "formats/model/errors.hpp"
#include "tools/case_builder/checks/case_check.hpp"

namespace palpate::cohort {
namespace {

using case_builder::Stage;
using case_builder::StageRunner;

bool reads_from(const Stage& stage, const Stage& earlier, const StageRunner& runner) {
    const auto reads = [&](const std::filesystem::path& file) {
        return std::ranges::find(stage.inputs, file) != stage.inputs.end();
    };
    return std::ranges::any_of(earlier.outputs, reads) || reads(runner.result_path(earlier.name));
}

}  // namespace

PatientBuild build_of(const Patient& patient, const CohortFolder& folder) {
    PatientBuild build{patient, {}, folder.build_of(patient.name), {}};
    if (!patient.mistake.empty()) return build;
    try {
        build.case_file = case_builder::read_case_file(patient.case_path, patient.overrides);
        case_builder::check_case_file(patient.case_path, build.case_file, patient.overrides);
        build.stages = stages_of(build.case_file, build.paths, case_builder::TouchClock::virtual_time);
    } catch (const Error& error) {
        const std::string what = error.what();
        build.patient.mistake = what.starts_with(patient.where) ? what : patient.where + ": " + what;
    }
    return build;
}

std::vector<std::size_t> stages_before(const PatientBuild& build, std::size_t stage) {
    const StageRunner runner({}, build.paths.parts, 1, true);
    std::vector<std::size_t> before;
    for (std::size_t i = 0; i < stage; ++i)
        if (reads_from(build.stages[stage], build.stages[i], runner)) before.push_back(i);
    // A report tells what all stages took.
    if (build.stages[stage].command == "report")
        for (std::size_t i = 0; i < stage; ++i)
            if (std::ranges::find(before, i) == before.end()) before.push_back(i);
    return before;
}

std::vector<StageState> states_of(const PatientBuild& build, const std::filesystem::path& programs) {
    const StageRunner runner(programs, build.paths.parts, 1, true);
    std::vector<StageState> states;
    for (std::size_t i = 0; i < build.stages.size(); ++i) {
        const Stage& stage = build.stages[i];
        StageState& state = states.emplace_back();
        const auto before = stages_before(build, i);
        if (std::ranges::any_of(
                before, [&](std::size_t j) { return states[j].kind != StageState::Kind::finished; })) {
            state.kind = StageState::Kind::waiting;
            continue;
        }
        prepare(stage, build.case_file, build.paths, build.stages, runner);
        if ((state.record = runner.finished(stage)))
            state.kind = StageState::Kind::finished;
        else if ((state.failure = runner.failed(stage)))
            state.kind = StageState::Kind::failed;
    }
    return states;
}

}  // namespace palpate::cohort
