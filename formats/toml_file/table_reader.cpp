// SPDX-License-Identifier: Apache-2.0
#include "formats/toml_file/table_reader.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "formats/model/label_map.hpp"

namespace palpate::toml_file {

TableReader::TableReader(const toml::table& table, std::string file, std::string where)
    : table_(table), file_(std::move(file)), where_(std::move(where)) {}

std::optional<std::string> TableReader::text_or_number(const std::string& key) {
    const toml::node* node = table_.get(key);
    if (node == nullptr || !node->is_integer()) return optional<std::string>(key);
    return std::to_string(*optional<std::int64_t>(key));
}

std::optional<std::string> TableReader::choice(const std::string& key,
                                               const std::vector<std::string>& choices) {
    const auto text = optional<std::string>(key);
    if (text && std::ranges::find(choices, *text) == choices.end())
        fail(*table_.get(key), key, "is '" + *text + "'", fmt::format("{}", fmt::join(choices, ", ")),
             "did you mean " + nearest_names(*text, choices).front() + "?");
    return text;
}

std::optional<std::filesystem::path> TableReader::path(const std::string& key) {
    const auto text = optional<std::string>(key);
    if (!text) return std::nullopt;
    const auto& written_in = node(key).source().path;
    return std::filesystem::path(written_in ? *written_in : file_).parent_path() / *text;
}

std::optional<double> TableReader::positive(const std::string& key) {
    const auto value = optional<double>(key);
    if (value && !(*value > 0)) fail(*table_.get(key), key, fmt::format("is {}", *value), "a number above 0");
    return value;
}

double TableReader::required_positive(const std::string& key) {
    required<double>(key);
    return *positive(key);
}

void TableReader::require_finite(const toml::node& node, const std::string& key, double value) const {
    if (!std::isfinite(value)) fail(node, key, fmt::format("is {}", value), "a finite number");
}

std::vector<double> TableReader::numbers(const std::string& key, std::size_t count) {
    known_.insert(key);
    const toml::array* array = table_.get_as<toml::array>(key);
    std::vector<double> values;
    if (array != nullptr)
        for (const toml::node& item : *array) {
            if (!item.is_number()) continue;
            values.push_back(*item.value<double>());
            require_finite(item, key, values.back());
        }
    if (array == nullptr || array->size() != count || values.size() != count)
        fail(node(key), key, "cannot be read", std::to_string(count) + " numbers in mm");
    return values;
}

std::optional<std::vector<double>> TableReader::optional_numbers(const std::string& key, std::size_t count) {
    known_.insert(key);
    if (!has(key)) return std::nullopt;
    return numbers(key, count);
}

TableReader TableReader::table(const std::string& key) {
    known_.insert(key);
    static const toml::table empty;
    const toml::node* node = table_.get(key);
    if (node == nullptr) return {empty, file_, place_of(key)};
    if (!node->is_table()) fail(*node, key, "has the wrong type", "a table");
    return {*node->as_table(), file_, place_of(key)};
}

std::vector<TableReader> TableReader::tables(const std::string& key) {
    known_.insert(key);
    std::vector<TableReader> readers;
    const toml::node* node = table_.get(key);
    if (node == nullptr) return readers;
    if (!node->is_array()) fail(*node, key, "has the wrong type", "an array of tables, [[" + key + "]]");
    for (const toml::node& item : *node->as_array()) {
        if (!item.is_table()) fail(item, key, "has the wrong type", "an array of tables, [[" + key + "]]");
        readers.emplace_back(*item.as_table(), file_, place_of(key));
    }
    return readers;
}

const toml::array& TableReader::list(const std::string& key) {
    known_.insert(key);
    static const toml::array empty;
    const toml::node* node = table_.get(key);
    if (node == nullptr) return empty;
    if (!node->is_array()) fail(*node, key, "has the wrong type", "a list");
    return *node->as_array();
}

void TableReader::refuse_unknown() const {
    for (const auto& [key, node] : table_) {
        const std::string name(key.str());
        if (known_.contains(name)) continue;
        const auto near = nearest_names(name, {known_.begin(), known_.end()});
        std::string hint;
        for (const std::string& candidate : near) hint += (hint.empty() ? "did you mean " : ", ") + candidate;
        fail(node, name, "is not known here", "", hint);
    }
}

ErrorDetail TableReader::complaint(const toml::node& node, const std::string& key, const std::string& found,
                                   const std::string& expected, const std::string& next_step) const {
    return {position_of(node),
            fmt::format("key '{}'{} {}", key, where_.empty() ? "" : " of " + where_, found), expected,
            next_step};
}

void TableReader::fail(const toml::node& node, const std::string& key, const std::string& found,
                       const std::string& expected, const std::string& next_step) const {
    throw InvalidInput(complaint(node, key, found, expected, next_step));
}

std::string TableReader::position_of(const toml::node& node) const {
    const auto& [begin, end, path] = node.source();
    const std::string& file = path ? *path : file_;
    return begin.line > 0 ? fmt::format("{}:{}", file, begin.line) : file;
}

const toml::node& TableReader::node(const std::string& key) const {
    const toml::node* found = table_.get(key);
    return found != nullptr ? *found : table_;
}

std::string TableReader::place_of(const std::string& key) const {
    return where_.empty() ? key : where_ + "." + key;
}

}  // namespace palpate::toml_file
