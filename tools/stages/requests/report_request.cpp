// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/stages/requests/report_request.hpp"

#include <charconv>

#include "tools/cli/items.hpp"

namespace palpate::stages {
namespace {

RigidOrigin parse_origin(const std::string& text) {
    const auto equals = text.find('='), comma = text.find(',', equals == std::string::npos ? 0 : equals);
    RigidOrigin origin{text.substr(0, equals), "", {}};
    if (equals != std::string::npos) origin.label = text.substr(equals + 1, comma - equals - 1);
    double value = 0;
    const char* end = text.data() + text.size();
    if (comma != std::string::npos && std::from_chars(text.data() + comma + 1, end, value).ptr == end)
        origin.isovalue = value;
    if (origin.body.empty() || origin.label.empty() || (comma != std::string::npos && !origin.isovalue))
        throw UsageError({"--rigid " + text, "cannot be read", "BODY=LABEL or BODY=LABEL,ISOVALUE", ""});
    return origin;
}

}  // namespace

void to_json(nlohmann::ordered_json& json, const RigidOrigin& origin) {
    json = {{"body", origin.body}, {"label", origin.label}};
    if (origin.isovalue) json["isovalue_hu"] = *origin.isovalue;
}

void from_json(const nlohmann::ordered_json& json, RigidOrigin& origin) {
    cli::refuse_other_keys(json, {"body", "label", "isovalue_hu"});
    origin = {json.at("body"), json.at("label"), {}};
    if (json.contains("isovalue_hu")) origin.isovalue = json.at("isovalue_hu").get<double>();
}

void declare(cli::Command& command, ReportRequest& request) {
    command.input("asset", request.asset, "case to report on (.vtkhdf)");
    command.input("--failed-with", request.failed_with,
                  "instead of a case: what a stage said that failed, by --error-file (.txt); the page shows "
                  "that and what there is");
    command.option("--name", request.name, "title of a page without a case");
    command.input("--volume", request.volume, "volume to show slices of, any format of 'palpate import'");
    command.input("--labels", request.labels, "label map to show contours of (.seg.nrrd)");
    command.items(
        "--rigid", cli::item_list(request.rigid, parse_origin),
        "BODY=LABEL or BODY=LABEL,ISOVALUE: what a rigid body was made from, to map its distance; repeat "
        "for more");
    command.input("--touch", request.touch, "statistics made by 'palpate touch --json'");
    command.input("--curve", request.curve, "force curve made by 'palpate touch --curve' (.svg)");
    command.input("--stages", request.stages, "stage times and peak memory made by 'palpate build' (.json)");
    command.output("--thumbnail", request.thumbnail, "small picture of the case to write as well (.png)");
    command.output("-o,--output", request.output, "page to write (.html)").required();
}

}  // namespace palpate::stages
