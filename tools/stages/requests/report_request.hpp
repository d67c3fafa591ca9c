// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "tools/cli/command.hpp"

namespace palpate::stages {

/// What a rigid body was made from: "skull=bone,226" or {"body": "skull", "label": "bone", "isovalue_hu":
/// 226}.
struct RigidOrigin {
    std::string body, label;
    std::optional<double> isovalue;  ///< HU; none: the label's outline
};

void to_json(nlohmann::ordered_json& json, const RigidOrigin& origin);
void from_json(const nlohmann::ordered_json& json, RigidOrigin& origin);

/// What `palpate report` is asked for; all but output and one of asset and failed_with may be empty.
struct ReportRequest {
    std::filesystem::path asset;        ///< .vtkhdf
    std::filesystem::path failed_with;  ///< what a stage said that failed, in place of an asset (.txt)
    std::string name;                   ///< of the case, in place of the asset's
    std::filesystem::path volume, labels;
    std::vector<RigidOrigin> rigid;   ///< bodies to compare with what they were made from
    std::filesystem::path touch;      ///< statistics of a run (.json)
    std::filesystem::path curve;      ///< its force curve (.svg)
    std::filesystem::path stages;     ///< what a build took (.json)
    std::filesystem::path thumbnail;  ///< small picture of the asset to write as well (.png)
    std::filesystem::path output;     ///< .html
};

/// Binds the options of `palpate report`.
void declare(cli::Command& command, ReportRequest& request);

}  // namespace palpate::stages
