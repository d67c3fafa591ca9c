// SPDX-License-Identifier: Apache-2.0
#include "formats/records/field.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstdio>
#include <utility>

namespace palpate {
namespace {

std::string short_text(double value) {
    std::array<char, 32> text{};
    std::snprintf(text.data(), text.size(), "%g", value);
    return text.data();
}

}  // namespace

std::string to_string(const Range& range) {
    const bool bounded_below = std::isfinite(range.least), bounded_above = std::isfinite(range.most);
    if (!bounded_below && !bounded_above) return "a finite number";
    if (bounded_below && bounded_above)
        return range.ends_belong ? short_text(range.least) + " to " + short_text(range.most)
                                 : "between " + short_text(range.least) + " and " + short_text(range.most);
    if (bounded_below && !range.ends_belong)
        return range.least == 0 ? "a positive number" : "more than " + short_text(range.least);
    return bounded_below ? short_text(range.least) + " or more" : "at most " + short_text(range.most);
}

std::string key_of(const char* name, std::string_view written_unit) {
    constexpr std::array<std::pair<std::string_view, const char*>, 9> endings{
        {{"mm", "_mm"},
         {"N", "_n"},
         {"N/mm", "_n_per_mm"},
         {"mm/N", "_mm_per_n"},
         {"N/ms", "_n_per_ms"},
         {"N s/mm", "_n_s_per_mm"},
         {"kPa", "_kpa"},
         {"s", "_s"},
         {"voxel diagonals", "_voxel_diagonals"}}};
    const auto found =
        std::ranges::find(endings, written_unit, &std::pair<std::string_view, const char*>::first);
    return found == endings.end() ? name : std::string(name) + found->second;
}

std::string option_name(std::string_view field_name) {
    std::string name = "--" + std::string(field_name);
    std::ranges::replace(name, '_', '-');
    return name;
}

std::string title_of(std::string_view field_name) {
    std::string title(field_name);
    std::ranges::replace(title, '_', ' ');
    if (!title.empty()) title[0] = static_cast<char>(std::toupper(static_cast<unsigned char>(title[0])));
    return title;
}

}  // namespace palpate
