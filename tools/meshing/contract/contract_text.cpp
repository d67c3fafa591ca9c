// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "tools/meshing/contract/contract.hpp"
#include "tools/meshing/files/text.hpp"

namespace palpate::meshing {
namespace {

bool is_count(const ContractCheck& check) {
    return check.unit.empty() && check.limit == 0;
}

}  // namespace

std::string what_text(const ContractCheck& check) {
    if (is_count(check) || check.unit == "degrees") return check.measure;
    return check.measure + " of " + (check.region_name.empty() ? "the body" : "'" + check.region_name + "'");
}

std::string value_text(const ContractCheck& check) {
    const std::string value = is_count(check)           ? fmt::format("{:.0f}", check.value)
                              : check.unit == "degrees" ? fmt::format("{:.1f}°", check.value)
                              : check.unit.empty()      ? fmt::format("{:.4f}", check.value)
                                                        : fmt::format("{:.3f} {}", check.value, check.unit);
    return check.at && !check.met ? value + " at " + place_text(*check.at) : value;
}

std::string limit_text(const ContractCheck& check) {
    if (is_count(check)) return "0";
    const std::string bound = check.bound == ContractCheck::Bound::at_least ? "at least " : "at most ";
    if (check.unit == "degrees") return bound + fmt::format("{:g}°", check.limit);
    if (check.unit.empty()) return bound + fmt::format("{:g}", check.limit);
    return bound + fmt::format("{:.3g} {}", check.limit, check.unit);
}

}  // namespace palpate::meshing
