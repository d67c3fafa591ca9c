// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/case_builder/toml_document.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <optional>
#include <tuple>
#include <vector>

#include "formats/model/errors.hpp"
#include "formats/model/label_map.hpp"
#include "formats/model/reading/utf8.hpp"
#include "formats/toml_file/parse_file.hpp"
#include "formats/toml_file/quoted.hpp"
#include "tools/case_builder/kept_case.hpp"

namespace palpate::case_builder {
namespace {

std::vector<std::string> parts_of(const std::string& key) {
    std::vector<std::string> parts{""};
    for (const char letter : key)
        if (letter == '.')
            parts.emplace_back();
        else
            parts.back() += letter;
    return parts;
}

[[noreturn]] void fail(const Override& override, const std::string& found, const std::string& expected,
                       const std::string& next_step) {
    throw InvalidInput({fmt::format("{}:{}", override.file.string(), override.line),
                        fmt::format("key '{}' {}", override.key, found), expected, next_step});
}

// What an element of an array of tables is called.
std::optional<std::string> name_of(const toml::table& element) {
    for (const char* key : {"name", "label"})
        if (const auto name = element[key].value<std::string>()) return name;
    return std::nullopt;
}

toml::table& element_of(toml::array& array, const std::string& name, const Override& override) {
    std::vector<std::string> names;
    for (toml::node& node : array) {
        toml::table* const element = node.as_table();
        const auto found = element != nullptr ? name_of(*element) : std::nullopt;
        if (found == name) return *element;
        if (found) names.push_back(*found);
    }
    const auto near = nearest_names(name, names);
    fail(override, fmt::format("names '{}', which the case file has none of", name), "",
         near.empty() ? "" : fmt::format("nearest names: '{}'", fmt::join(near, "', '")));
}

toml::table& table_below(toml::table& table, const std::string& key, const Override& override) {
    if (!table.contains(key)) table.insert(key, toml::table{});
    toml::node& node = *table.get(key);
    if (!node.is_table()) fail(override, fmt::format("goes through '{}'", key), "a table", "");
    return *node.as_table();
}

// The value under the key "value", with the override's file and line as its source.
toml::table parsed(const Override& override) {
    const std::string lines(static_cast<std::size_t>(override.line - 1), '\n');
    const auto parse = [&](const std::string& value) {
        return toml::parse(lines + "value = " + value, override.file.string());
    };
    if (!is_utf8(override.value)) fail(override, "has a value that is no UTF-8", "", "write it as UTF-8");
    try {
        return parse(override.value);
    } catch (const toml::parse_error&) {
        return parse(toml_file::quoted(override.value));
    }
}

void apply(const Override& override, toml::table& document) {
    const std::vector<std::string> parts = parts_of(override.key);
    toml::table* at = &document;
    std::size_t i = 0;
    while (i + 1 < parts.size())
        if (toml::array* const array = at->get_as<toml::array>(parts[i]);
            array != nullptr && i + 2 < parts.size()) {
            at = &element_of(*array, parts[i + 1], override);
            i += 2;
        } else {
            at = &table_below(*at, parts[i], override);
            ++i;
        }
    // Moved, not copied: a copy forgets where it was written.
    toml::table value = parsed(override);
    value.get("value")->visit(
        [&]<typename Node>(Node& node) { at->insert_or_assign(parts.back(), std::move(node)); });
}

}  // namespace

toml::table read_toml(const std::filesystem::path& path, std::span<const Override> overrides) {
    const char* const see = "see docs/case_file.md";
    toml::table document = is_asset(path) ? toml_file::parse_text(case_kept_in(path), path, see)
                                          : toml_file::parse_file(path, see);
    for (const Override& override : overrides) apply(override, document);
    return document;
}

std::vector<std::string> keys_as_written(const toml::table& table) {
    std::vector<std::tuple<bool, toml::source_position, std::string>> found;
    for (const auto& [key, node] : table)
        found.emplace_back(!key.source().begin, key.source().begin, key.str());
    std::ranges::sort(found);
    std::vector<std::string> keys;
    for (const auto& [added, position, key] : found) keys.push_back(key);
    return keys;
}

}  // namespace palpate::case_builder
