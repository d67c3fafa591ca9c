// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cohort/bids/bids_name.hpp"

#include <algorithm>

namespace palpate::cohort {

std::string BidsName::operator[](std::string_view entity) const {
    const auto found = std::ranges::find(entities, entity, &std::pair<std::string, std::string>::first);
    return found == entities.end() ? "" : found->second;
}

bool BidsName::has_all_of(const BidsName& other) const {
    return std::ranges::all_of(other.entities, [&](const auto& entity) {
        return std::ranges::find(entities, entity) != entities.end();
    });
}

std::optional<BidsName> parse_bids_name(std::string_view name, bool needs_suffix) {
    BidsName parsed;
    const std::size_t dot = std::min(name.find('.'), name.size());
    parsed.extension = name.substr(dot);
    name = name.substr(0, dot);
    while (!name.empty()) {
        const std::size_t end = std::min(name.find('_'), name.size()), dash = name.find('-');
        const bool last = end == name.size();
        if (dash < end) {
            if (dash == 0 || dash + 1 == end) return std::nullopt;
            parsed.entities.emplace_back(name.substr(0, dash), name.substr(dash + 1, end - dash - 1));
        } else if (last) {
            parsed.suffix = name;
        } else {
            return std::nullopt;
        }
        name = last ? "" : name.substr(end + 1);
    }
    if (needs_suffix && (parsed.suffix.empty() || parsed.entities.empty())) return std::nullopt;
    return parsed;
}

std::string spelled(const BidsName& name) {
    std::string text;
    for (const auto& [entity, value] : name.entities) text += entity + "-" + value + "_";
    return text + name.suffix + name.extension;
}

}  // namespace palpate::cohort
