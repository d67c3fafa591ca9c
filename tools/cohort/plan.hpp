// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <vector>

#include "tools/cohort/patient_build.hpp"

namespace palpate::cohort {

/// True for each stage that is worth running: it is not finished, and neither it nor a stage before it failed
/// on what the same input would meet again.
std::vector<bool> stages_to_do(const PatientBuild& build, const std::vector<StageState>& states);

/// What pipelines/Snakefile reads: the stages to do of each patient with those of them that go before.
/// `table_folder` is where paths in the table begin.
nlohmann::ordered_json plan_of(std::span<const PatientBuild> builds,
                               std::span<const std::vector<StageState>> states, const CohortFolder& folder,
                               const std::filesystem::path& table_folder,
                               const std::filesystem::path& programs);

/// What `palpate build --request` takes to build a patient as his row says.
nlohmann::ordered_json request_of(const PatientBuild& build);

}  // namespace palpate::cohort
