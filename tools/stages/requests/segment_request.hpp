// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/cli/command.hpp"

namespace palpate::stages {

/// One structure to segment.
struct StructureRequest {
    std::string words;  ///< "skull: recipe=bone threshold_hu=226", as people type it; else:
    std::string name;
    std::string recipe;
    /// By name, in the order written; `palpate segment` knows which exist and refuses the rest.
    nlohmann::ordered_json parameters = nlohmann::ordered_json::object();
};

void to_json(nlohmann::ordered_json& json, const StructureRequest& structure);
void from_json(const nlohmann::ordered_json& json, StructureRequest& structure);

/// What `palpate segment` is asked for.
struct SegmentRequest {
    std::filesystem::path volume, labels;
    std::filesystem::path recipes;  ///< more structures as JSON, before `structures`
    std::vector<StructureRequest> structures;
    std::filesystem::path preview;  ///< picture of the result to write as well (.png)
    std::filesystem::path output;   ///< .seg.nrrd
};

/// Binds the options of `palpate segment`.
void declare(cli::Command& command, SegmentRequest& request);

}  // namespace palpate::stages
