// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <functional>
#include <vector>

#include "tools/cohort/patient_build.hpp"
#include "tools/cohort/results.hpp"

namespace palpate::cohort {

/// A table as it is built.
struct Cohort {
    std::filesystem::path table;  ///< absolute
    CohortFolder folder;
    std::vector<PatientBuild> builds;
};

/// The builds of a table's patients into a folder, and their case files' mistakes.
Cohort cohort_of(const std::vector<Patient>& patients, const std::filesystem::path& table,
                 const std::filesystem::path& output);

/// The cohort in a folder, by the table that it was built from last. Throws InvalidInput if the folder is
/// none of `palpate batch` or the table is gone, and what read_patient_table() throws.
Cohort cohort_in(const std::filesystem::path& folder);

/// Leaves in the folder what `palpate build --request` takes for each patient, and where the table is.
void write_requests(const Cohort& cohort);

/// Throws InvalidInput if a `palpate batch` builds the cohort at this moment, or a `palpate export`
/// copies it: who holds the FolderLock "batch" of its batch().
void refuse_while_built(const CohortFolder& folder);

using States = std::vector<std::vector<StageState>>;

/// states_of() every patient; `before_each` is told what part is done, 0 ... 1.
States states_of_all(const Cohort& cohort, const std::filesystem::path& programs,
                     const std::function<void(double)>& before_each);

}  // namespace palpate::cohort
