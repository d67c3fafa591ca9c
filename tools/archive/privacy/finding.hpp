// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace palpate::archive {

/// Something in a file that tells a patient, a person, a machine or a place on its disk.
struct Finding {
    std::filesystem::path file;
    std::string where;  ///< in the file: a line, an attribute, a header field
    std::string kind;   ///< "patient attribute", "date", "path", ...
    std::string value;  ///< shortened() so that it does not leak here
};

/// The first two characters of a value and how many it has.
std::string shortened(const std::string& value);

}  // namespace palpate::archive
