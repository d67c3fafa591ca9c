// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <toml++/toml.h>
#include <type_traits>
#include <vector>

#include "formats/model/errors.hpp"

namespace palpate::toml_file {

/// Reads one table of a TOML file and remembers which keys it was asked for, so that the others can be
/// refused. Everything throws InvalidInput naming file, line and key if a value is missing or has the wrong
/// type. The table must outlive its reader.
class TableReader {
  public:
    /// `where` is the table's own key, empty for the whole file.
    TableReader(const toml::table& table, std::string file, std::string where);

    template <typename T>
    std::optional<T> optional(const std::string& key) {
        known_.insert(key);
        const toml::node* node = table_.get(key);
        if (node == nullptr) return std::nullopt;
        // toml++ would take true for 1 and 1 for true.
        if (node->is_boolean() == std::is_same_v<T, bool>)
            if (const auto value = node->value<T>()) {
                if constexpr (std::is_floating_point_v<T>) require_finite(*node, key, *value);
                return value;
            }
        fail(*node, key, "has the wrong type",
             std::is_same_v<T, std::string> ? "text"
             : std::is_same_v<T, bool>      ? "true or false"
                                            : "a number");
    }

    template <typename T>
    T required(const std::string& key) {
        if (auto value = optional<T>(key)) return *value;
        fail(table_, key, "is missing", "");
    }

    /// Text, or a whole number written as text.
    std::optional<std::string> text_or_number(const std::string& key);

    /// A text that must be one of a few.
    std::optional<std::string> choice(const std::string& key, const std::vector<std::string>& choices);

    /// A path, as from the folder of the file in which it is written.
    std::optional<std::filesystem::path> path(const std::string& key);

    /// A number above zero.
    std::optional<double> positive(const std::string& key);
    double required_positive(const std::string& key);

    /// Exactly `count` numbers.
    std::vector<double> numbers(const std::string& key, std::size_t count);
    std::optional<std::vector<double>> optional_numbers(const std::string& key, std::size_t count);

    /// A sub-table; an empty one if it is absent.
    TableReader table(const std::string& key);

    /// The tables of an array of tables, [[key]]; none if it is absent.
    std::vector<TableReader> tables(const std::string& key);

    /// The elements of an array of anything; none if it is absent.
    const toml::array& list(const std::string& key);

    bool has(const std::string& key) const { return table_.contains(key); }
    const toml::table& raw() const { return table_; }

    /// Throws for a key that nobody asked for, with the nearest known ones.
    void refuse_unknown() const;

    /// "file:line: key 'key' of where found (expected ...); next step".
    ErrorDetail complaint(const toml::node& node, const std::string& key, const std::string& found,
                          const std::string& expected, const std::string& next_step = "") const;
    /// Throws InvalidInput with that.
    [[noreturn]] void fail(const toml::node& node, const std::string& key, const std::string& found,
                           const std::string& expected, const std::string& next_step = "") const;

    /// "file:line" of a node, of the file in which it is written.
    std::string position_of(const toml::node& node) const;
    /// What holds a key's value; the table itself if it has none.
    const toml::node& node(const std::string& key) const;

  private:
    void require_finite(const toml::node& node, const std::string& key, double value) const;
    std::string place_of(const std::string& key) const;

    const toml::table& table_;
    std::string file_, where_;
    std::set<std::string> known_;
};

}  // namespace palpate::toml_file
