// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "formats/model/body.hpp"
#include "tools/report/quality.hpp"

namespace palpate::report {

/// One figure of a body, what it means and whether it is as it must be.
struct Check {
    std::string name;
    std::string value;    ///< with its unit
    std::string limit;    ///< "≤ 1e-6"; empty for a figure that is only told
    std::string meaning;  ///< in plain words
    bool holds = true;
};

/// Errors under contacts that a certificate may have, as fem::allowed_load_error() gives them.
struct AllowedLoadError {
    double surface = 0, contact = 0;
};

/// Judges what was measured when the body was condensed, and the shape of its mesh; its errors under contacts
/// against `allowed`, or like all others where that is missing.
std::vector<Check> checks_of(const DeformableBody& body, const MeshSummary& mesh,
                             std::optional<AllowedLoadError> allowed_load_error = {});

}  // namespace palpate::report
