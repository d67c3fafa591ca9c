// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>

namespace palpate::visual {

/// The first path "palpate-CASE-N" with that extension (".png") in `folder`, N = 1, 2, ..., at which nothing
/// is yet; in CASE what is neither letter, digit, hyphen nor underscore becomes an underscore.
std::filesystem::path free_path(const std::filesystem::path& folder, const std::string& case_name,
                                const std::string& extension);

}  // namespace palpate::visual
