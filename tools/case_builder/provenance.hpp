// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/case_builder/case_file.hpp"
#include "tools/case_builder/stage_runner.hpp"

namespace palpate::case_builder {

/// What made an asset, for the asset: the case to build it again from, digests of the inputs, the structures,
/// and the request of each stage `before` the packing but the imports. No folder, and no file name of the
/// patient's: imported files are called after their bodies. `runner` tells how many threads condensed a body,
/// on which its last digits depend.
nlohmann::ordered_json provenance(const CaseFile& case_file, std::span<const Stage> before,
                                  const StageRunner* runner = nullptr);

/// How many threads condensed an asset's bodies, if its provenance tells.
std::optional<int> threads_of(const std::filesystem::path& asset);

/// What differs between a case and the one that an asset was built of: names of inputs whose content is
/// another, "structures", or else "case". Throws InvalidInput if the asset keeps none.
std::vector<std::string> changed_since(const std::filesystem::path& asset, const CaseFile& case_file);

}  // namespace palpate::case_builder
