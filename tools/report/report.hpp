// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <future>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "formats/model/body.hpp"
#include "formats/model/label_map.hpp"
#include "tools/report/charts.hpp"
#include "tools/report/verdict.hpp"

namespace palpate::report {

/// How far one body's surface is from what it was made from.
struct SurfaceComparison {
    std::string body;                                    ///< name in the case
    std::string against;                                 ///< "the outline of liver and tumour", for people
    std::vector<double> triangle_distances;              ///< mm, one for each triangle of the body's surface
    double mean = 0, percentile_95 = 0, maximum = 0;     ///< mm, both ways
    Eigen::Vector3d farthest = Eigen::Vector3d::Zero();  ///< p_P where it is `maximum`
};

/// What a report is made of. A section whose input is missing says which option fills it.
struct ReportInputs {
    const Case& patient_case;
    const Volume* volume = nullptr;
    const LabelMap* labels = nullptr;
    std::optional<nlohmann::json> touch{};  ///< result of `palpate touch --json`
    std::string force_curve_svg{};          ///< picture made by `palpate touch --curve`; empty if none
    std::vector<StageRecord> stages{};
    std::shared_future<std::vector<SurfaceComparison>> comparisons{};  ///< may go on beside drawing; or none
    std::vector<AllowedLoadError> allowed_load_errors{};  ///< of each deformable body, or none of any
};

/// Reads stage records from [{"stage", "seconds", "peak_memory_bytes", "status"}, ...], where a missing
/// status means "run"; throws InvalidInput naming `culprit` and the record at fault.
std::vector<StageRecord> stages_from_json(const nlohmann::json& json, const std::string& culprit);

/// Makes a page on a case that could not be built: what failed, as it was said, slices through what images
/// there are, and what the stages before took. Needs no display.
std::string html_failure(const ReportInputs& inputs, const std::string& message);

/// Draws all bodies small, as the report's first picture of them, 190 by 155 pixels; a PNG file's bytes.
/// Needs a display as html_report() does.
std::string thumbnail_png(const Case& patient_case);

/// Makes one self-contained HTML page: no script, no link, pictures within. Draws in 3-D, so it needs an X
/// display or Xvfb (VirtualDisplay); throws SystemFailure where there is neither, and what comparisons throw.
std::string html_report(const ReportInputs& inputs);

}  // namespace palpate::report
