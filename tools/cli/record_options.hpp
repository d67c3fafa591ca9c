// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "formats/records/field.hpp"
#include "tools/cli/command.hpp"

namespace palpate::cli {

/// Adds an option for every field of a record, set to its present value; `before` is put before each meaning.
template <typename Table, typename Record>
void record_options(Command& command, const Table& table, Record& record, const std::string& before = "") {
    for_each_field(table, [&](const auto& field) {
        command.option(option_name(field.name), record.*field.member, before + field.meaning, field.unit,
                       key_of(field));
    });
}

}  // namespace palpate::cli
