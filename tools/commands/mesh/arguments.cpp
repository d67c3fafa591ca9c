// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/commands/mesh/arguments.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "formats/model/errors.hpp"

namespace palpate::mesh {
namespace {

std::vector<double> parse_numbers(const std::string& text) {
    std::vector<double> numbers;
    const char* at = text.c_str();
    const char* const end = at + text.size();
    while (at < end) {
        double value = 0;
        const auto [next, error] = std::from_chars(at, end, value);
        if (error != std::errc{} || !std::isfinite(value) || (next < end && *next != ',') || next + 1 == end)
            return {};
        numbers.push_back(value);
        at = next + 1;
    }
    return numbers;
}

}  // namespace

RegionSize parse_region_size(const std::string& text, const LabelMap& map,
                             const std::vector<std::int32_t>& regions, const std::string& culprit) {
    const std::size_t equals = text.rfind('=');
    const std::vector<double> size =
        equals == std::string::npos ? std::vector<double>{} : parse_numbers(text.substr(equals + 1));
    if (size.size() != 1)
        throw UsageError({"--region-cell-size", "'" + text + "'", "NAME=MM, such as tumour=4", ""});
    const RegionSize result{.region = require_label(map, text.substr(0, equals), culprit).value,
                            .cell_size = size[0]};
    if (std::ranges::find(regions, result.region) == regions.end())
        throw UsageError({"--region-cell-size", "'" + text + "' is no region of the body",
                          "one of those named with --region", ""});
    return result;
}

NearSize parse_near(const std::string& text, const LabelMap& map, const std::string& culprit) {
    const std::size_t equals = text.rfind('=');
    const std::vector<double> sizes =
        equals == std::string::npos ? std::vector<double>{} : parse_numbers(text.substr(equals + 1));
    if (sizes.size() != 2)
        throw UsageError({"--near", "'" + text + "'",
                          "NAME=SIZE,WITHIN or X,Y,Z=SIZE,WITHIN in mm, such as tumour=3,10", ""});
    NearSize near{.points = {}, .within = sizes[1], .cell_size = sizes[0]};
    const std::vector<double> point = parse_numbers(text.substr(0, equals));
    if (point.size() == 3)
        near.points.emplace_back(point[0], point[1], point[2]);
    else
        near.label = require_label(map, text.substr(0, equals), culprit).value;
    return near;
}

std::map<std::int32_t, std::string> parse_region_names(const std::vector<std::string>& texts) {
    std::map<std::int32_t, std::string> names;
    for (const std::string& text : texts) {
        const std::size_t equals = text.find('=');
        const std::vector<double> value =
            equals == std::string::npos ? std::vector<double>{} : parse_numbers(text.substr(0, equals));
        if (value.size() != 1 || value[0] != std::floor(value[0]) || std::abs(value[0]) > 65535 ||
            equals + 1 == text.size())
            throw UsageError({"--region-name", "'" + text + "'", "VALUE=NAME, such as 4=tumour", ""});
        names[static_cast<std::int32_t>(value[0])] = text.substr(equals + 1);
    }
    return names;
}

}  // namespace palpate::mesh
