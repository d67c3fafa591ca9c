// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>

#include "tools/case_builder/stages.hpp"

namespace palpate::cohort {

/// Where a cohort's files go: assets, reports, statuses and the page in `root`, what they are made with in
/// `root`/.batch. A class for its names; it makes no folder.
struct CohortFolder {
    std::filesystem::path root;  ///< absolute

    case_builder::BuildPaths build_of(const std::string& patient) const;
    std::filesystem::path status_of(const std::string& patient) const;   ///< .json
    std::filesystem::path request_of(const std::string& patient) const;  ///< of `palpate build`, .json
    std::filesystem::path log_of(const std::string& patient, const std::string& stage_file) const;
    std::filesystem::path batch() const;       ///< Snakemake's working directory, and the lock
    std::filesystem::path done() const;        ///< a stamp for each stage of this run, <patient>/<stage>
    std::filesystem::path table_name() const;  ///< text: where the table is that it was built from last
    std::filesystem::path bids_table() const;  ///< the table that a BIDS dataset became, .tsv
    std::filesystem::path plan() const;        ///< what Snakemake reads, .json
    std::filesystem::path snakemake_log() const;
    std::filesystem::path results() const;     ///< a line for each patient, .tsv
    std::filesystem::path benchmarks() const;  ///< a line for each finished stage, .tsv
    std::filesystem::path page() const;        ///< .html
};

/// A stage's name as a file's: "mesh-liver".
std::string file_name_of(const std::string& stage);

}  // namespace palpate::cohort
