// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <toml++/toml.h>

namespace palpate::toml_file {

/// Reads a TOML file of at most 1 MiB and 4096 full stops in its keys. Throws InvalidInput naming file and
/// line for a syntax error, with `next_step`.
toml::table parse_file(const std::filesystem::path& path, const std::string& next_step);

/// The same of a text that `path` holds.
toml::table parse_text(const std::string& text, const std::filesystem::path& path,
                       const std::string& next_step);

}  // namespace palpate::toml_file
