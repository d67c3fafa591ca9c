// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <span>
#include <string>
#include <toml++/toml.h>
#include <vector>

#include "tools/case_builder/overrides.hpp"

namespace palpate::case_builder {

/// Reads a TOML file, or what an asset keeps of one, some of its values replaced or added. Tables on an
/// override's way are made where they are missing, elements of arrays are not. Throws InvalidInput naming
/// file and line for a syntax error, and for an override whose key leads nowhere.
toml::table read_toml(const std::filesystem::path& path, std::span<const Override> overrides = {});

/// The keys of a table in the order in which they are written; toml++ keeps them by name. Those that an
/// override adds are written nowhere in the file and come last.
std::vector<std::string> keys_as_written(const toml::table& table);

}  // namespace palpate::case_builder
