// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json.hpp>

#include "formats/records/field.hpp"

namespace palpate::cli {

/// A record as JSON, each field under key_of(), in the unit that people write; null where it was not
/// measured.
template <typename Table, typename Record>
nlohmann::ordered_json record_json(const Table& table, const Record& record) {
    nlohmann::ordered_json json = nlohmann::ordered_json::object();
    for_each_field(table, [&](const auto& field) {
        const auto& value = record.*field.member;
        auto& entry = json[key_of(field)];
        if (field.not_measured && value == *field.not_measured)
            entry = nullptr;
        else if (field.written_unit != nullptr)
            entry = field.written_factor * static_cast<double>(value);
        else
            entry = value;
    });
    return json;
}

}  // namespace palpate::cli
