// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace palpate::inspection {

/// What is in a file.
struct Summary {
    std::string form;  ///< "volume", "labels", "mesh", "surface", "obb_tree", "body"; empty: an asset
    nlohmann::ordered_json json;  ///< for programs; lengths in mm, places in LPS
    std::string text;             ///< for people; empty: the JSON says it well enough
};

}  // namespace palpate::inspection
