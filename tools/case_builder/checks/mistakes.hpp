// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <fmt/format.h>
#include <string>
#include <vector>

#include "formats/model/errors.hpp"

namespace palpate::case_builder {

/// Everything that is wrong with a case file, in the order of the checks.
using Mistakes = std::vector<ErrorDetail>;

/// Throws InvalidInput that names every mistake; nothing where there is none.
inline void throw_mistakes(const std::filesystem::path& case_file, const Mistakes& mistakes) {
    if (mistakes.empty()) return;
    if (mistakes.size() == 1) throw InvalidInput(mistakes.front());
    std::string all = fmt::format("has {} mistakes:", mistakes.size());
    for (const ErrorDetail& mistake : mistakes) all += "\n  " + to_string(mistake);
    throw InvalidInput({case_file.string(), all, "", ""});
}

}  // namespace palpate::case_builder
