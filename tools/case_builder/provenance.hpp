// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <nlohmann/json.hpp>
#include <span>

#include "tools/case_builder/case_file.hpp"
#include "tools/case_builder/stage_runner.hpp"

namespace palpate::case_builder {

/// What made an asset, for the asset: digests of the inputs, the structures, and the request of each stage
/// `before` the packing but
/// the imports. No folder, and no file name of the patient's: imported files are called after their bodies.
nlohmann::ordered_json provenance(const CaseFile& case_file, std::span<const Stage> before);

}  // namespace palpate::case_builder
