// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/case_builder/kept_case.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sstream>

#include "formats/asset/asset.hpp"
#include "formats/model/errors.hpp"
#include "formats/toml_file/quoted.hpp"
#include "tools/case_builder/overrides.hpp"
#include "tools/case_builder/toml_document.hpp"
#include "tools/imaging/recipes/recipe.hpp"

namespace palpate::case_builder {
namespace {

using Json = nlohmann::ordered_json;

bool is_letter_or_digit(unsigned char c) {
    return std::isalnum(c) != 0;
}

// ".nii.gz" of "Doe.nii.gz"; none of "Doe.John", whose ending may be a name.
std::string kind_of(const std::filesystem::path& file) {
    constexpr std::array kinds{".nii.gz", ".seg.nrrd", ".nii", ".nrrd", ".nhdr", ".mha",  ".mhd", ".vti",
                               ".vtk",    ".dcm",      ".vtp", ".vtu",  ".stl",  ".obj",  ".ply", ".msh",
                               ".mesh",   ".json",     ".csv", ".tsv",  ".txt",  ".ctbl", ".fcsv"};
    const std::string name = file.filename().string();
    const auto kind = std::ranges::find_if(kinds, [&](const char* k) { return name.ends_with(k); });
    return kind != kinds.end() ? *kind : "";
}

std::string as_file_name(std::string words) {
    std::ranges::replace_if(
        words, [](unsigned char c) { return !is_letter_or_digit(c) && c != '-'; }, '_');
    return words;
}

std::filesystem::path resolved(const toml::node& text) {
    const auto& written_in = text.source().path;
    return std::filesystem::path(written_in ? *written_in : "").parent_path() / *text.value<std::string>();
}

// A number, a flag or a text as TOML writes it.
std::string leaf(const toml::node& node) {
    if (const auto number = node.value_exact<double>()) {
        const std::string digits = fmt::format("{}", *number);
        return digits.find_first_of(".en") == std::string::npos ? digits + ".0" : digits;
    }
    std::ostringstream stream;
    node.visit([&](const auto& value) { stream << value; });
    return stream.str();
}

bool has_header(const toml::node& node) {
    return node.is_table() && !node.as_table()->is_inline();
}

std::string below(const std::string& place, const std::string& key) {
    return place.empty() ? key : place + "_" + key;
}

bool may_stay(const std::string& key, const toml::node& node) {
    const auto text = node.value_exact<std::string>();
    return key != "series" || !text || keeps_series(*text);
}

bool names_file(const std::string& key, const std::filesystem::path& file) {
    std::error_code none;  // what is too long for a path is none
    if (key == "label_names") return std::filesystem::is_regular_file(file, none);
    return key == "volume" || key == "labels" || key.ends_with("_file") || imaging::is_file_parameter(key);
}

// The value of `key`. `place` is what a file is called there.
std::string value(const toml::node& node, const std::string& key, const std::string& place) {
    if (const toml::table* table = node.as_table()) {
        std::vector<std::string> pairs;
        for (const std::string& inner : keys_as_written(*table))
            if (may_stay(inner, *table->get(inner)))
                pairs.push_back(inner + " = " + value(*table->get(inner), inner, below(place, inner)));
        return fmt::format("{{ {} }}", fmt::join(pairs, ", "));
    }
    if (const toml::array* array = node.as_array()) {
        std::vector<std::string> items;
        for (const toml::node& item : *array)
            items.push_back(value(item, key, fmt::format("{}_{}", place, items.size() + 1)));
        return fmt::format("[{}]", fmt::join(items, ", "));
    }
    if (node.is_string())
        if (const std::filesystem::path file = resolved(node); names_file(key, file))
            return toml_file::quoted(as_file_name(place) + kind_of(file));
    return leaf(node);
}

// What stands below a header: values, then tables with headers of their own.
std::string block(const toml::table& table, const std::string& header, const std::string& place) {
    std::string values, blocks;
    for (const std::string& key : keys_as_written(table)) {
        const toml::node& node = *table.get(key);
        const std::string inner = header.empty() ? key : header + "." + key;
        const toml::array* const array = node.as_array();
        if (has_header(node)) {
            const std::string inside = header.empty() ? "" : below(place, key);
            blocks += fmt::format("\n[{}]\n{}", inner, block(*node.as_table(), inner, inside));
        } else if (array != nullptr && !array->empty() && std::ranges::all_of(*array, has_header)) {
            int count = 0;
            for (const toml::node& element : *array) {
                const toml::table& each = *element.as_table();
                const std::string numbered = below(place, fmt::format("{}_{}", key, ++count));
                const std::string name = each["name"].value_or(numbered);
                // Of a name that is none for a file, another may make the same.
                const std::string inside = header.empty() && as_file_name(name) == name ? name : numbered;
                blocks += fmt::format("\n[[{}]]\n{}", inner, block(each, inner, inside));
            }
        } else if (may_stay(key, node)) {
            values += fmt::format("{} = {}\n", key, value(node, key, below(place, key)));
        }
    }
    return values + blocks;
}

}  // namespace

bool keeps_series(const std::string& series) {
    return std::ranges::all_of(series, [](unsigned char c) { return std::isdigit(c) != 0; });
}

std::string kept_case(const toml::table& document) {
    return block(document, "", "");
}

bool is_asset(const std::filesystem::path& case_file) {
    return case_file.extension() == ".vtkhdf";
}

std::string case_kept_in(const std::filesystem::path& path) {
    return kept_build(path).case_text;
}

KeptBuild kept_build(const std::filesystem::path& path) {
    constexpr int most_threads = 1024;
    const auto refuse = [&](const char* found) {
        throw InvalidInput(
            {path.string(), found, "an asset of palpate build", "pass the case file that it was made of"});
    };
    const auto provenance = Json::parse(asset::read_asset(path).provenance, nullptr, false);
    const Json build = provenance.is_object() ? provenance.value("build", Json()) : Json();
    if (!build.is_object() || !build.contains("case") || !build["case"].is_string())
        refuse("keeps no case to build again");
    KeptBuild kept;
    kept.case_text = build["case"];
    kept.structures = build.value("structures", Json());
    kept.series_left_out = build.contains("series_left_out");
    const Json inputs = build.value("inputs", Json::object()), steps = build.value("steps", Json::array());
    for (const auto& [name, digest] : inputs.items()) {
        if (!digest.is_string()) refuse("names its inputs in a way of its own");
        kept.inputs[name] = digest;
    }
    for (const Json& step : steps)
        if (step.is_object() && step.contains("threads") && !kept.threads) {
            const Json& threads = step["threads"];
            if (!threads.is_number_integer() || threads < 1 || threads > most_threads)
                refuse("was condensed by a number of threads that is none");
            kept.threads = threads.get<int>();
        }
    return kept;
}

}  // namespace palpate::case_builder
