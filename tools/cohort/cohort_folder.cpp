// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cohort/cohort_folder.hpp"

#include <algorithm>

namespace palpate::cohort {

case_builder::BuildPaths CohortFolder::build_of(const std::string& patient) const {
    return {root / (patient + ".parts"), root / (patient + ".vtkhdf"), root / (patient + ".html")};
}
std::filesystem::path CohortFolder::status_of(const std::string& patient) const {
    return root / (patient + ".json");
}
std::filesystem::path CohortFolder::request_of(const std::string& patient) const {
    return batch() / "requests" / (patient + ".json");
}
std::filesystem::path CohortFolder::log_of(const std::string& patient, const std::string& stage_file) const {
    return root / "logs" / patient / (stage_file + ".log");
}
std::filesystem::path CohortFolder::batch() const {
    return root / ".batch";
}
std::filesystem::path CohortFolder::done() const {
    return batch() / "done";
}
std::filesystem::path CohortFolder::table_name() const {
    return batch() / "table";
}
std::filesystem::path CohortFolder::bids_table() const {
    return root / "patients.tsv";
}
std::filesystem::path CohortFolder::plan() const {
    return batch() / "plan.json";
}
std::filesystem::path CohortFolder::snakemake_log() const {
    return root / "logs" / "snakemake.log";
}
std::filesystem::path CohortFolder::results() const {
    return root / "results.tsv";
}
std::filesystem::path CohortFolder::benchmarks() const {
    return root / "stages.tsv";
}
std::filesystem::path CohortFolder::page() const {
    return root / "index.html";
}

std::string file_name_of(const std::string& stage) {
    std::string name = stage;
    std::ranges::replace(name, ' ', '-');
    return name;
}

}  // namespace palpate::cohort
