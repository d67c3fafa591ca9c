// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace palpate::cli {

/// What provenance says of the software: {"palpate": version, "libraries": {"CGAL": "5.5.1", ...}}, the
/// libraries that this build stands on.
nlohmann::ordered_json software_versions();

/// The folder of the program that runs, in which all the others are. Throws filesystem_error without /proc.
std::filesystem::path programs_folder();

}  // namespace palpate::cli
