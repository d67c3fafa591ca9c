// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "formats/model/body.hpp"
#include "formats/model/label_map.hpp"
#include "tools/report/charts.hpp"

namespace palpate {

/// What a report is made of. A section whose input is missing says which option fills it.
struct ReportInputs {
    const Case& patient_case;
    const Volume* volume = nullptr;
    const LabelMap* labels = nullptr;
    std::optional<nlohmann::json> touch{};  ///< result of `palpate touch --json`
    std::string force_curve_svg{};          ///< picture made by `palpate touch --curve`; empty if none
    std::vector<StageRecord> stages{};
};

/// Reads stage records from [{"stage", "seconds", "peak_memory_bytes", "status"}, ...], where a missing
/// status means "run"; throws InvalidInput naming `culprit` and the record at fault.
std::vector<StageRecord> stages_from_json(const nlohmann::json& json, const std::string& culprit);

/// Makes one self-contained HTML page: no script, no link, pictures within. Draws in 3-D, so it needs an X
/// display or Xvfb (VirtualDisplay); throws SystemFailure where there is neither.
std::string html_report(const ReportInputs& inputs);

}  // namespace palpate
