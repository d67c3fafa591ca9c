// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <toml++/toml.h>

namespace palpate::case_builder {

/// A case as its asset keeps it, to be built again: TOML of the document, overrides in it, keys in the order
/// written. Without what leads to a person: comments, a series' text, and what files are called, for which
/// their keys stand ("volume.nii.gz", "liver_seeds.json").
std::string kept_case(const toml::table& document);

/// What an asset's provenance says of its build, "case" among it. Throws InvalidInput if it has none.
nlohmann::ordered_json build_kept_in(const std::filesystem::path& asset);

/// The case of build_kept_in().
std::string case_kept_in(const std::filesystem::path& asset);

/// Whether a case file is an asset, by its name.
bool is_asset(const std::filesystem::path& case_file);

}  // namespace palpate::case_builder
