// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "tools/report/html.hpp"
#include "tools/report/sections.hpp"

namespace palpate {

std::string contract_section(const std::string& provenance) {
    const nlohmann::json json = nlohmann::json::parse(provenance, nullptr, false);
    const auto text = [](const nlohmann::json& check, const char* key) {
        return html::escaped(check.value(key, ""));
    };
    std::vector<std::vector<std::string>> rows;
    if (json.is_object() && json.value("meshes", nlohmann::json()).is_object())
        for (const auto& [body, mesh] : json["meshes"].items())
            for (const nlohmann::json& check : mesh.value("checks", nlohmann::json::array()))
                rows.push_back({html::escaped(body), text(check, "what"), text(check, "found"),
                                text(check, "limit"),
                                check.value("kept", false) ? "kept" : "<strong>missed</strong>"});
    return html::section(
        "contract", "Quality contract",
        "What the mesh of each body had to keep when it was made, and what was measured.",
        rows.empty() ? html::missing("The asset records no contract.")
                     : html::table({{"Body"}, {"What"}, {"Found", true}, {"Limit", true}, {""}}, rows));
}

}  // namespace palpate
