// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>

#include "tools/case_builder/case_file.hpp"

namespace palpate::case_builder {

/// Looks in a case file for what would stop a build later on: recipes and their parameters, names that no
/// structure has, files that are not there, rules that can pick nothing, bodies that nothing holds, materials
/// out of range, inputs that a recipe lacks. `case_file` is what read_case_file() made of `path` and
/// `overrides`, its inputs perhaps replaced. Reads no image. Throws InvalidInput that names every mistake
/// with line and key.
void check_case_file(const std::filesystem::path& path, const CaseFile& case_file,
                     std::span<const Override> overrides = {});

}  // namespace palpate::case_builder
