// SPDX-License-Identifier: Apache-2.0
#include "tools/cli/result_lines.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <ostream>

namespace palpate::cli {
namespace {

std::string cell_text(const nlohmann::ordered_json& value) {
    if (value.is_string()) return value.get<std::string>();
    if (value.is_number_float()) return fmt::format("{:.4g}", value.get<double>());
    return value.dump();
}

bool is_table(const nlohmann::ordered_json& value) {
    return value.is_array() && !value.empty() &&
           std::ranges::all_of(value, [](const auto& row) { return row.is_object(); });
}

bool are_sentences(const nlohmann::ordered_json& value) {
    return value.is_array() && !value.empty() && std::ranges::all_of(value, [](const auto& item) {
               return item.is_string() &&
                      item.template get_ref<const std::string&>().find(' ') != std::string::npos;
           });
}

// Rows of scalars under their keys, columns as wide as their widest cell, and an empty line; nested values
// are left to --json.
void print_table(const nlohmann::ordered_json& rows, const std::string& name, std::ostream& stream) {
    std::vector<std::string> keys;
    for (const auto& [key, cell] : rows.front().items())
        if (cell.is_primitive()) keys.push_back(key);
    stream << name << '\n';
    std::vector<std::size_t> widths;
    for (const std::string& key : keys) {
        std::size_t width = key.size();
        for (const auto& row : rows)
            width = std::max(width, cell_text(row.value(key, nlohmann::ordered_json())).size());
        widths.push_back(width);
        stream << fmt::format("  {:<{}}", key, width);
    }
    for (const auto& row : rows) {
        stream << '\n';
        for (std::size_t k = 0; k < keys.size(); ++k)
            stream << fmt::format("  {:<{}}", cell_text(row.value(keys[k], nlohmann::ordered_json())),
                                  widths[k]);
    }
    stream << "\n\n";
}

// `spaced`: whether an empty line, or nothing, stands before.
void print_lines(const nlohmann::ordered_json& value, const std::string& prefix, std::ostream& stream,
                 bool& spaced) {
    for (const auto& [key, item] : value.items()) {
        const std::string name = prefix.empty() ? key : prefix + "." + key;
        if (item.is_object()) {
            print_lines(item, name, stream, spaced);
            continue;
        }
        if (is_table(item)) {
            if (!spaced) stream << '\n';
            print_table(item, name, stream);
            spaced = true;
            continue;
        }
        spaced = false;
        if (are_sentences(item))
            for (const auto& sentence : item) stream << name << ' ' << cell_text(sentence) << '\n';
        else
            stream << name << ' ' << cell_text(item) << '\n';
    }
}

}  // namespace

void print_result(const nlohmann::ordered_json& result, std::ostream& stream) {
    bool spaced = true;
    print_lines(result, "", stream, spaced);
}

}  // namespace palpate::cli
