// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/cohort/patient_build.hpp"

namespace palpate::cohort {

/// A figure by which patients of a cohort are compared.
struct Figure {
    const char* key;   ///< "volume_ml", in tables
    const char* name;  ///< "Volume", for people
    const char* unit;  ///< "ml"
};

/// The figures that a PatientResult has, in order.
std::span<const Figure> figures();

enum class Outcome { built, failed, unfinished };
const char* name_of(Outcome outcome);

/// What came of a patient.
struct PatientResult {
    std::string patient;
    Outcome outcome = Outcome::unfinished;
    std::string failed_stage;  ///< empty if none failed, or if his row or case file has a mistake
    std::string said;          ///< why it failed, in the words of what failed
    case_builder::BuildPaths paths;
    std::vector<std::string> stages;
    std::vector<StageState> states;  ///< one for each stage
    std::vector<std::optional<double>>
        figures;  ///< one for each of figures(); none where it is not known yet
};

PatientResult result_of(const PatientBuild& build, std::vector<StageState> states);

/// A patient's status, schema palpate.patient/1: outcome, files, figures, and of each stage what became of
/// it.
nlohmann::ordered_json status_json(const PatientResult& result);

/// Tab-separated, with a line of column names: patient, outcome, stage that failed, figures, what was said.
std::string results_table(std::span<const PatientResult> results);
/// Tab-separated: patient, stage, seconds and peak memory of each finished stage.
std::string stages_table(std::span<const PatientResult> results);
/// For a terminal: how many were built, and for each that was not, why.
std::string summary_text(std::span<const PatientResult> results);

/// True for a value that stands apart from the others: 0.6745 |x - median| > 3.5 times the median distance
/// from the median (B. Iglewicz, D. Hoaglin, How to Detect and Handle Outliers, 1993). Of fewer than five
/// values none does.
std::vector<bool> outliers(std::span<const std::optional<double>> values);

}  // namespace palpate::cohort
