// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/contract/contract_json.hpp"

#include <limits>
#include <nlohmann/json.hpp>

namespace palpate::meshing {

nlohmann::ordered_json to_json(const ContractCheck& check) {
    nlohmann::ordered_json json{{"name", check.name}, {"measure", check.measure}};
    if (!check.region_name.empty()) json["region"] = check.region_name;
    json["value"] = check.value;
    json["bound"] = check.bound == ContractCheck::Bound::at_least ? "at least" : "at most";
    json["limit"] = check.limit;
    json["unit"] = check.unit;
    json["met"] = check.met;
    if (check.at) json["at_mm"] = {check.at->x(), check.at->y(), check.at->z()};
    return json;
}

std::optional<ContractCheck> contract_check_from(const nlohmann::ordered_json& json) try {
    ContractCheck check;
    check.name = json.at("name");
    check.measure = json.at("measure");
    check.region_name = json.value("region", "");
    // JSON has no infinity: a region that is missing is infinitely far.
    check.value =
        json.at("value").is_null() ? std::numeric_limits<double>::infinity() : json.at("value").get<double>();
    check.bound =
        json.at("bound") == "at least" ? ContractCheck::Bound::at_least : ContractCheck::Bound::at_most;
    check.limit = json.at("limit");
    check.unit = json.at("unit");
    check.met = json.at("met");
    if (json.contains("at_mm")) {
        const auto at = json.at("at_mm").get<std::vector<double>>();
        if (at.size() == 3) check.at = {at[0], at[1], at[2]};
    }
    return check;
} catch (const nlohmann::ordered_json::exception&) {
    return std::nullopt;
}

}  // namespace palpate::meshing
