// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <map>
#include <string>
#include <string_view>

#include "formats/model/label_map.hpp"

namespace palpate {

/// Reads "5=liver,4=gallbladder"; throws UsageError if it is malformed or names a value or a name twice.
std::map<std::int32_t, std::string> parse_label_names(std::string_view text);

/// Names labels by value and turns all others into background. Throws InvalidInput if a value does not
/// occur in the map.
void rename_labels(LabelMap& map, const std::map<std::int32_t, std::string>& names);

}  // namespace palpate
