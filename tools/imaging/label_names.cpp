// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/label_names.hpp"

#include <algorithm>
#include <charconv>
#include <set>
#include <sstream>

#include "formats/model/errors.hpp"

namespace palpate {

std::map<std::int32_t, std::string> parse_label_names(std::string_view text) {
    std::map<std::int32_t, std::string> names;
    std::set<std::string> seen;
    std::istringstream stream{std::string(text)};
    for (std::string part; std::getline(stream, part, ',');) {
        const auto equals = part.find('=');
        std::int32_t value = 0;
        const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), value);
        const bool good = equals != std::string::npos && equals + 1 < part.size() && error == std::errc{} &&
                          end == part.data() + equals && value > 0 && value < 65536;
        if (!good)
            throw UsageError({"label names", "'" + part + "'", "value=name with a value of 1 ... 65535",
                              "write them as 5=liver,4=gallbladder"});
        if (!names.emplace(value, part.substr(equals + 1)).second || !seen.insert(names[value]).second)
            throw UsageError({"label names", "'" + part + "' repeats a value or a name", "",
                              "give each value its own name"});
    }
    return names;
}

void rename_labels(LabelMap& map, const std::map<std::int32_t, std::string>& names) {
    std::vector<Label> renamed;
    for (const auto& [value, name] : names) {
        Label label = require_label(map, std::to_string(value), "label names");
        label.name = name;
        renamed.push_back(std::move(label));
    }
    map.names = std::move(renamed);
    for (std::uint16_t& value : map.labels)
        if (!names.contains(value)) value = 0;
}

}  // namespace palpate
