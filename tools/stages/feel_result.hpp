// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

#include "formats/model/body.hpp"
#include "tools/fem/feel/feel.hpp"

namespace palpate::stages {

/// What can be felt of a body's regions, a row for each; none of a body without feel.
std::vector<nlohmann::ordered_json> felt_rows(const DeformableBody& body);

/// How stiff the surface is: least, median and largest stiffness of the vertices that can be pressed, N/mm,
/// with tool and depth; null of a body without feel.
nlohmann::ordered_json feel_summary(const DeformableBody& body);

/// Why a region of a body cannot be felt and what to try, in a sentence. `trials` are felt_trials().
std::string unfelt_warning(const DeformableBody& body, const FeltRegion& felt,
                           std::span<const fem::FeltTrial> trials);

}  // namespace palpate::stages
