// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>

namespace palpate::cli {

/// Prints a result to stdout for people: lines "name value", and a table for each list of objects.
void print_result(const nlohmann::ordered_json& result);

}  // namespace palpate::cli
