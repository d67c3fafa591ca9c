// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "tools/case_builder/stage_runner.hpp"
#include "tools/cohort/cohort_folder.hpp"
#include "tools/cohort/patient_table.hpp"

namespace palpate::cohort {

/// What is known of one stage of a patient.
struct StageState {
    enum class Kind {
        finished,
        failed,   ///< when it ran last, on what is there now
        waiting,  ///< for a stage before it
        to_do
    };
    Kind kind = Kind::to_do;
    std::optional<case_builder::StageRecord> record;    ///< of `finished`
    std::optional<case_builder::StageFailure> failure;  ///< of `failed`
};

/// One patient's build.
struct PatientBuild {
    Patient patient;  ///< its mistake also names what is wrong with the case file
    case_builder::CaseFile case_file;
    case_builder::BuildPaths paths;
    std::vector<case_builder::Stage> stages;  ///< none if there is a mistake
};

/// Reads and checks the patient's case file as his row changes it.
PatientBuild build_of(const Patient& patient, const CohortFolder& folder);

/// Looks at each stage of the build, in order, by the digests of what it reads and wrote. `programs` holds
/// the palpate-<command> executables.
std::vector<StageState> states_of(const PatientBuild& build, const std::filesystem::path& programs);

/// Which of the build's stages a stage reads from, as indices.
std::vector<std::size_t> stages_before(const PatientBuild& build, std::size_t stage);

}  // namespace palpate::cohort
