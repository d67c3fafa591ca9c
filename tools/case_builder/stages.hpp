// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "tools/case_builder/case_file.hpp"
#include "tools/case_builder/stage_runner.hpp"

namespace palpate::case_builder {

/// Where a build's files go.
struct BuildPaths {
    std::filesystem::path parts;   ///< folder of intermediate results
    std::filesystem::path asset;   ///< .vtkhdf
    std::filesystem::path report;  ///< .html
};

/// How the finished asset is pressed for four seconds: in real time, which tells how this machine keeps up,
/// or as fast as possible, which tells the same of the forces on a machine that does other work.
enum class TouchClock { real, virtual_time };

/// Lists all stages of a build in order, from image to report.
std::vector<Stage> stages_of(const CaseFile& case_file, const BuildPaths& paths,
                             TouchClock clock = TouchClock::real);

/// Throws InvalidInput where a file is not there that another stage is to make for this one, naming that
/// stage.
void require_made(const Stage& stage, const std::vector<Stage>& stages, const StageRunner& runner);

/// Writes what a stage reads that no stage makes: of "pack" how the asset was made, provenance.json; of
/// "report" what the stages took, stages.json. To be called when the stages before are done.
void prepare(const Stage& stage, const CaseFile& case_file, const BuildPaths& paths,
             const std::vector<Stage>& stages, const StageRunner& runner);

/// Where a failed build shows what there is.
std::filesystem::path failure_page(const BuildPaths& paths);

/// The stage that writes failure_page() where `failed` did: what it said, and slices through what the stages
/// before it made.
Stage failure_stage(const CaseFile& case_file, const BuildPaths& paths, const std::vector<Stage>& stages,
                    const Stage& failed, const StageRunner& runner);

}  // namespace palpate::case_builder
