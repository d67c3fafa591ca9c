// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/files/label_names.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <set>
#include <sstream>

#include "formats/model/errors.hpp"

namespace palpate::imaging {
namespace {

void name_by_table(LabelMap& map, const LabelTable& table, const std::string& source, const NoteSink& note) {
    std::vector<std::int32_t> unknown;
    for (Label& label : map.names)
        if (const auto found = table.find(label.value); found != table.end())
            label = found->second;
        else
            unknown.push_back(label.value);
    if (unknown.size() == map.names.size())
        throw InvalidInput({source, "names none of the values " + fmt::format("{}", fmt::join(unknown, ", ")),
                            "the table of this label map", "choose another table"});
    if (note && !unknown.empty())
        note(fmt::format("the table has no name for {}; kept as they were", fmt::join(unknown, ", ")));
}

void note_unnamed(const LabelMap& map, const NoteSink& note) {
    const auto unnamed = std::ranges::count_if(
        map.names, [](const Label& label) { return label.name == fmt::format("label_{}", label.value); });
    if (note && unnamed > 0)
        note(fmt::format(
            "the file does not name {} of its {} labels; name them with --label-names, from a table "
            "or by value",
            unnamed, map.names.size()));
}

}  // namespace

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
        const auto label = std::ranges::find(map.names, value, &Label::value);
        if (label == map.names.end()) require_label(map, std::to_string(value), "label names");
        renamed.push_back(*label);
        renamed.back().name = name;
    }
    map.names = std::move(renamed);
    for (std::uint16_t& value : map.labels)
        if (!names.contains(value)) value = 0;
}

void name_labels(LabelMap& map, const std::string& source, const NoteSink& note) {
    constexpr std::string_view prefix = "totalsegmentator:";
    if (source.empty()) return note_unnamed(map, note);
    if (source.starts_with(prefix))
        name_by_table(map, totalsegmentator_table(source.substr(prefix.size())), source, note);
    else if (std::filesystem::is_regular_file(source))
        name_by_table(map, read_label_table(source), source, note);
    else if (source.find('=') != std::string::npos)
        rename_labels(map, parse_label_names(source));
    else
        throw UsageError({"label names", "'" + source + "' is no file and no known table",
                          "a label table, totalsegmentator:v2/total or 5=liver,4=gallbladder",
                          "check the path"});
    make_names_unique(map, note);
}

void make_names_unique(LabelMap& map, const NoteSink& note) {
    std::set<std::string> seen;
    std::map<std::string, int> number_of;  // next one of a name that repeats
    std::size_t repeated = 0;
    for (Label& label : map.names) {
        const std::string name = label.name;
        while (!seen.insert(label.name).second)
            label.name = fmt::format("{}_{}", name, number_of.try_emplace(name, 2).first->second++);
        repeated += label.name != name;
    }
    if (note && repeated > 0) note(fmt::format("{} labels repeat a name; numbered _2, _3 ...", repeated));
}

}  // namespace palpate::imaging
