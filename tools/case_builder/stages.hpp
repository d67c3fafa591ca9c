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

/// Lists the stages from image to asset, in order; the last one is "pack". Writes what made the
/// asset's parts, provenance.json, into `paths.parts`.
std::vector<Stage> stages_to_asset(const CaseFile& case_file, const BuildPaths& paths);

/// The stage that presses the finished asset for four seconds of real time.
Stage touch_stage(const BuildPaths& paths);

/// The stage that writes the report; `records` are what the earlier stages took, `touch_result` is the JSON
/// result of touch_stage().
Stage report_stage(const CaseFile& case_file, const BuildPaths& paths,
                   const std::vector<StageRecord>& records, const std::filesystem::path& touch_result);

/// Where a failed build shows what there is.
std::filesystem::path failure_page(const BuildPaths& paths);

/// The stage that writes failure_page() where another failed: what it said (`error`, .txt), and slices
/// through what `records`' stages made.
Stage failure_stage(const CaseFile& case_file, const BuildPaths& paths,
                    const std::vector<StageRecord>& records, const std::filesystem::path& error);

}  // namespace palpate::case_builder
