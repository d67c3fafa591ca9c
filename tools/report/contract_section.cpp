// SPDX-License-Identifier: GPL-3.0-or-later
#include <nlohmann/json.hpp>

#include "tools/meshing/contract/contract_json.hpp"
#include "tools/report/html.hpp"
#include "tools/report/sections.hpp"

namespace palpate::report {
namespace {

using namespace meshing;

using Row = std::vector<std::string>;

Row row_of(const std::string& body, const nlohmann::ordered_json& item) {
    std::string what, found, limit;
    bool met = false;
    if (const auto check = contract_check_from(item)) {
        what = what_text(*check);
        found = value_text(*check);
        limit = limit_text(*check);
        met = check->met;
    } else if (item.is_object()) {  // the first assets hold sentences
        what = item.value("what", "");
        found = item.value("found", "");
        limit = item.value("limit", "");
        met = item.value("kept", false);
    }
    return {html::escaped(body), html::escaped(what), html::escaped(found), html::escaped(limit),
            met ? "met" : "<strong>missed</strong>"};
}

}  // namespace

std::string contract_section(const ReportPage& page) {
    const auto json = nlohmann::ordered_json::parse(page.inputs.patient_case.provenance, nullptr, false);
    std::vector<Row> rows;
    if (json.is_object() && json.contains("meshes") && json["meshes"].is_object())
        for (const auto& [body, mesh] : json["meshes"].items())
            for (const nlohmann::ordered_json& item : mesh.value("checks", nlohmann::ordered_json::array()))
                rows.push_back(row_of(body, item));
    return html::section(
        "contract", "Quality contract",
        "What the mesh of each body had to keep when it was made, and what was measured.",
        rows.empty() ? html::missing("The asset records no contract.")
                     : html::table({{"Body"}, {"What"}, {"Found", true}, {"Limit", true}, {""}}, rows));
}

}  // namespace palpate::report
