// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <toml++/toml.h>

namespace palpate::case_builder {

/// A case as its asset keeps it, to be built again: TOML of the document, overrides in it, keys in the order
/// written. Without what leads to a person: comments, a series' UID or description, and what files are
/// called, for which their keys stand ("volume.nii.gz", "liver_seeds_file.json").
std::string kept_case(const toml::table& document);

/// Whether the choice of a series may stay: its number; a UID or description leads to the archive that it is
/// from.
bool keeps_series(const std::string& series);

/// What an asset says of its build.
struct KeptBuild {
    std::string case_text;                      ///< see kept_case()
    std::map<std::string, std::string> inputs;  ///< SHA-256 of each by its name, "volume_sha256"
    nlohmann::ordered_json structures;          ///< with digests of their files
    std::optional<int> threads;                 ///< that condensed its first body
    bool series_left_out = false;               ///< a series was chosen by what the asset does not tell
};

/// Reads an asset and what it keeps. Throws InvalidInput if it keeps no case, or what no build writes.
KeptBuild kept_build(const std::filesystem::path& asset);

/// The case text of kept_build().
std::string case_kept_in(const std::filesystem::path& asset);

/// Whether a case file is an asset, by its name.
bool is_asset(const std::filesystem::path& case_file);

}  // namespace palpate::case_builder
