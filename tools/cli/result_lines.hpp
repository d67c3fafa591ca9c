// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <iosfwd>
#include <nlohmann/json_fwd.hpp>

namespace palpate::cli {

/// Prints a result for people: lines "name value", and a table for each list of objects.
void print_result(const nlohmann::ordered_json& result, std::ostream& stream);

}  // namespace palpate::cli
