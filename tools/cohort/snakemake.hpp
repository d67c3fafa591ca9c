// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <functional>
#include <string>

#include "tools/cohort/cohort_folder.hpp"

namespace palpate::cohort {

/// What Snakemake tells of a stage's job.
struct JobEvent {
    enum class Kind { started, finished, failed };
    Kind kind = Kind::started;
    std::string patient;
    std::string stage;  ///< as a file's name, "mesh-liver"
};

/// How Snakemake runs.
struct SnakemakeRun {
    std::filesystem::path pipelines;  ///< folder of the Snakefile, its log handler and the profiles
    std::string profile;              ///< name of a profile there, or a folder
    int cores = 1;                    ///< jobs at once of the profile "local"
};

/// Runs the folder's plan to its end, whether stages fail or not; each event as it comes. An interrupt ends
/// the jobs that run and then this function, by Interrupted. Throws InvalidInput for an unknown profile and
/// SystemFailure if Snakemake is missing or ends without having run a stage.
void run_snakemake(const SnakemakeRun& run, const CohortFolder& folder,
                   const std::function<void(const JobEvent&)>& on_event);

}  // namespace palpate::cohort
