// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cmath>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <type_traits>

namespace palpate {

/// Which finite numbers a field may hold.
struct Range {
    double least = -std::numeric_limits<double>::infinity();
    double most = std::numeric_limits<double>::infinity();
    bool ends_belong = true;

    constexpr bool contains(double value) const {
        return ends_belong ? value >= least && value <= most : value > least && value < most;
    }
    /// The same in another unit, of which there are `factor` to one.
    constexpr Range in_units(double factor) const {
        return {.least = least * factor, .most = most * factor, .ends_belong = ends_belong};
    }
};
inline constexpr Range any_number{};
inline constexpr Range positive{.least = 0, .ends_belong = false};
inline constexpr Range not_negative{.least = 0};

/// "a positive number", "0 or more", "0 to 180", "between -1 and 0.5"; "a finite number" for any.
std::string to_string(const Range& range);

/// One field of a record. A record's table, a std::tuple of its fields, is the one place that names them:
/// options, case files, assets, recordings, JSON, reports and the references in docs/ visit it. The default
/// of a new record is the member's initialiser.
template <typename Record, typename T, typename Stored = T>
struct Field {
    using Value = T;
    using Storage = Stored;  ///< its type in a file

    const char* name;  ///< "tool_radius"; in an asset or a recording as it is
    T Record::*member;
    const char* unit;     ///< "mm", the system's; empty for a number without one
    const char* meaning;  ///< one clause, without a full stop
    Range range = any_number;
    int schema = 1;                      ///< of the files that brought it
    std::optional<T> absent{};           ///< what files mean that lack it, for good; none: they are refused
    std::optional<T> not_measured{};     ///< the value that says that there is none
    const char* written_unit = nullptr;  ///< where people write another unit: "kPa",
    double written_factor = 1;           ///< so many of which are one of `unit`

    constexpr Field(const char* name, T Record::*member, const char* unit, const char* meaning,
                    Range range = any_number)
        : name(name), member(member), unit(unit), meaning(meaning), range(range) {}

    /// The same field, brought by a later schema; files before it mean `value`.
    constexpr Field since(int brought_by, T value) const {
        Field field = *this;
        field.schema = brought_by;
        field.absent = value;
        return field;
    }
    /// The same field, where `value` says that it was not measured.
    constexpr Field none_is(T value) const {
        Field field = *this;
        field.not_measured = value;
        return field;
    }
    /// The same field, which people write in another unit.
    constexpr Field written_in(const char* other_unit, double factor) const {
        Field field = *this;
        field.written_unit = other_unit;
        field.written_factor = factor;
        return field;
    }
    /// The same field, stored as another type of number.
    template <typename Other>
    constexpr Field<Record, T, Other> stored_as() const {
        Field<Record, T, Other> field(name, member, unit, meaning, range);
        field.schema = schema;
        field.absent = absent;
        field.not_measured = not_measured;
        field.written_unit = written_unit;
        field.written_factor = written_factor;
        return field;
    }
};

/// Calls visit(field) for every field of a table, in its order.
template <typename Table, typename Visit>
constexpr void for_each_field(const Table& table, Visit&& visit) {
    std::apply([&](const auto&... field) { (visit(field), ...); }, table);
}

/// What a record holds that its table does not allow.
struct FieldError {
    std::string name;      ///< "tool_radius"
    std::string found;     ///< "is -1.000000 mm"
    std::string expected;  ///< "a positive number"
};

/// Returns the first field of numbers that is not finite or out of its range; none if all are sound.
template <typename Record, typename Table>
std::optional<FieldError> first_error(const Table& table, const Record& record) {
    std::optional<FieldError> error;
    for_each_field(table, [&](const auto& field) {
        const auto value = static_cast<double>(record.*field.member);
        if (error || (std::isfinite(value) && field.range.contains(value))) return;
        if (field.not_measured && value == static_cast<double>(*field.not_measured)) return;
        const std::string unit = *field.unit != '\0' ? " " + std::string(field.unit) : "";
        error = FieldError{field.name, "is " + std::to_string(value) + unit, to_string(field.range)};
    });
    return error;
}

/// The key of a field in case files and JSON, its name and written unit: "tool_radius_mm".
std::string key_of(const char* name, std::string_view written_unit);
template <typename Record, typename T, typename Stored>
std::string key_of(const Field<Record, T, Stored>& field) {
    return key_of(field.name, field.written_unit != nullptr ? field.written_unit : field.unit);
}

/// The same of the field that a table has for a member; empty if it has none.
template <typename Table, typename Record, typename T>
std::string key_of(const Table& table, T Record::*member) {
    std::string key;
    for_each_field(table, [&](const auto& field) {
        if constexpr (std::is_same_v<decltype(field.member), T Record::*>)
            if (field.member == member) key = key_of(field);
    });
    return key;
}

/// The name of the option that sets a field: "--tool-radius".
std::string option_name(std::string_view field_name);

/// A field's name as a heading: "Tool radius".
std::string title_of(std::string_view field_name);

}  // namespace palpate
