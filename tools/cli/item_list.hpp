// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

namespace palpate::cli {

/// How a command reads and writes a list of records that it is given one by one.
struct ItemList {
    std::function<void(const std::vector<std::string>&)> read;  ///< from words, or JSON objects as text
    std::function<nlohmann::ordered_json()> write;              ///< a JSON array of objects
};

}  // namespace palpate::cli
