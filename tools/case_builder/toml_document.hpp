// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <span>
#include <toml++/toml.h>

#include "tools/case_builder/overrides.hpp"

namespace palpate::case_builder {

/// Reads a TOML file, some of its values replaced or added. Tables on an override's way are made where they
/// are missing, elements of arrays are not. Throws InvalidInput naming file and line for a syntax error, and
/// for an override whose key leads nowhere.
toml::table read_toml(const std::filesystem::path& path, std::span<const Override> overrides = {});

}  // namespace palpate::case_builder
