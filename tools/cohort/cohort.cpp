// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cohort/cohort.hpp"

#include <fstream>
#include <nlohmann/json.hpp>

#include "formats/model/errors.hpp"
#include "tools/case_builder/folder_lock.hpp"
#include "tools/cli/outputs/staged_file.hpp"
#include "tools/cohort/plan.hpp"

namespace palpate::cohort {

Cohort cohort_of(const std::vector<Patient>& patients, const std::filesystem::path& table,
                 const std::filesystem::path& output) {
    Cohort cohort{std::filesystem::absolute(table).lexically_normal(),
                  {std::filesystem::absolute(output).lexically_normal()},
                  {}};
    for (const Patient& patient : patients) cohort.builds.push_back(build_of(patient, cohort.folder));
    return cohort;
}

Cohort cohort_in(const std::filesystem::path& folder) {
    const CohortFolder names{std::filesystem::absolute(folder).lexically_normal()};
    std::string table;
    if (std::ifstream stream(names.table_name()); !stream || !std::getline(stream, table))
        throw InvalidInput({folder.string(), "is no cohort", "the OUTPUT of 'palpate batch'",
                            "build one first; to export a label map or a surface, name its file"});
    if (!std::filesystem::exists(table))
        throw InvalidInput({folder.string(), "was built from " + table + ", which is not there", "",
                            "put the table back, or build the cohort again from where it is now"});
    return cohort_of(read_patient_table(table), table, folder);
}

void write_requests(const Cohort& cohort) {
    const CohortFolder& folder = cohort.folder;
    std::filesystem::remove_all(folder.batch() / "requests");
    std::filesystem::create_directories(folder.batch() / "requests");
    for (const PatientBuild& build : cohort.builds)
        if (build.patient.mistake.empty())
            cli::write_text_file(folder.request_of(build.patient.name), request_of(build).dump(2) + "\n",
                                 true);
    cli::write_text_file(folder.table_name(), cohort.table.string() + "\n", true);
}

void refuse_while_built(const CohortFolder& folder) {
    if (std::filesystem::exists(folder.batch()) &&
        case_builder::FolderLock::held_by_another(folder.batch(), "batch"))
        throw InvalidInput({folder.root.string(), "is being built by another palpate batch, or exported", "",
                            "wait for it or end it; what it finished is kept"});
}

States states_of_all(const Cohort& cohort, const std::filesystem::path& programs,
                     const std::function<void(double)>& before_each) {
    States states;
    for (const PatientBuild& build : cohort.builds) {
        before_each(static_cast<double>(states.size()) / static_cast<double>(cohort.builds.size()));
        states.push_back(states_of(build, programs));
    }
    return states;
}

}  // namespace palpate::cohort
