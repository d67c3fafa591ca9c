// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/archive/objects/segment_codes.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <map>
#include <sstream>

#include "tools/archive/objects/segment_code_table.hpp"

namespace palpate::archive {
namespace {

std::string simple_name(std::string_view name) {
    std::string simple(name);
    for (char& c : simple)
        c = c == ' ' || c == '-' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return simple;
}

std::map<std::string, Code> read_table() {
    std::map<std::string, Code> codes;
    std::istringstream table{std::string(segment_code_table)};
    for (std::string line; std::getline(table, line);) {
        if (line.starts_with('#')) continue;
        std::istringstream cells(line);
        std::string name, value, meaning;
        std::getline(cells, name, '\t');
        std::getline(cells, value, '\t');
        std::getline(cells, meaning);
        codes.emplace(simple_name(name), Code{value, "SCT", meaning});
    }
    return codes;
}

std::optional<Code> coded_type(const std::string& name) {
    static const std::map<std::string, Code> codes = read_table();
    const auto found = codes.find(name);
    return found == codes.end() ? std::nullopt : std::optional(found->second);
}

// What is left of a name without the side, which is cut off before, behind or from "rib_left_3"'s middle.
std::string without(const std::string& name, const std::string& side) {
    if (name.starts_with(side + "_")) return name.substr(side.size() + 1);
    if (name.ends_with("_" + side)) return name.substr(0, name.size() - side.size() - 1);
    const auto middle = name.find("_" + side + "_");
    return middle == std::string::npos ? "" : name.substr(0, middle) + name.substr(middle + side.size() + 1);
}

}  // namespace

SegmentCodes codes_of(std::string_view name) {
    const Code anatomical{"123037004", "SCT", "Anatomical Structure"},
        altered{"49755003", "SCT", "Morphologically Altered Structure"};
    const auto category = [&](const Code& type) {
        return type.meaning == "Neoplasm" || type.meaning == "Cyst" ? altered : anatomical;
    };
    const std::string simple = simple_name(name);
    if (const auto type = coded_type(simple)) return {category(*type), *type, {}, true};
    const std::array sides{Code{"7771000", "SCT", "Left"}, Code{"24028007", "SCT", "Right"}};
    for (const Code& side : sides)
        if (const auto type = coded_type(without(simple, simple_name(side.meaning))))
            return {category(*type), *type, side, true};
    return {anatomical, {"85756007", "SCT", "Tissue"}, {}, false};
}

}  // namespace palpate::archive
