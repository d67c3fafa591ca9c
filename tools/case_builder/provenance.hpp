// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "tools/case_builder/case_file.hpp"
#include "tools/case_builder/kept_case.hpp"
#include "tools/case_builder/stage_runner.hpp"

namespace palpate::case_builder {

/// What made an asset, for the asset: the case to build it again from, digests of the inputs, the structures,
/// and the request of each stage `before` the packing but the imports. No folder, and no file name of the
/// patient's: imported files are called after their bodies. `runner` tells how many threads condensed a body,
/// on which its last digits depend.
nlohmann::ordered_json provenance(const CaseFile& case_file, std::span<const Stage> before,
                                  const StageRunner* runner = nullptr);

/// What differs between a case and the one that an asset was built of: names of inputs whose content is
/// another, "structures", or else "case".
std::vector<std::string> changed_since(const KeptBuild& then, const CaseFile& case_file);

}  // namespace palpate::case_builder
