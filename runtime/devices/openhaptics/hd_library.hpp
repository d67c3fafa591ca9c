// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <span>
#include <string>

#include "formats/model/errors.hpp"
#include "runtime/devices/openhaptics/hd_api.hpp"

namespace palpate::devices {

/// Names the environment variable that holds the path of a driver's HDAPI library.
inline constexpr const char* hd_library_variable = "PALPATE_HD_LIBRARY";

/// Lists the names under which OpenHaptics installs its HDAPI library, in the order they are tried.
std::span<const char* const> hd_library_names();

/// Explains `message`, which dlerror() gave for `library`: what is missing or wrong, and its fix. For
/// messages of glibc's loader, in English.
ErrorDetail explain_load_error(const std::string& library, const std::string& message);

/// Loads an HDAPI library: `user_path` if it is not empty, else what PALPATE_HD_LIBRARY names, else the
/// first of hd_library_names() that is there. A library is loaded once and stays until the process ends,
/// because drivers fail when they are loaded again. Throws InvalidInput where the user's library cannot be
/// used and SystemFailure where none of the known names can, with cause and fix. Any thread.
const HdApi& load_hd_library(const std::filesystem::path& user_path);

}  // namespace palpate::devices
