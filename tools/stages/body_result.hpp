// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <nlohmann/json_fwd.hpp>

#include "formats/model/body.hpp"
#include "tools/stages/body.hpp"

namespace palpate::stages {

/// What a certificate says, by the names of its figures.
nlohmann::ordered_json to_json(const Certificate& certificate);

/// A condensed body in figures, its plan and its certificate; how it sagged, or null.
nlohmann::ordered_json to_json(const MadeBody& made);

/// What was chosen, why, and every method's forecast.
nlohmann::ordered_json to_json(const fem::CondensationPlan& plan);

/// "linear" or "quadratic".
std::string name_of(ElementOrder order);

/// "dense", or "hierarchical to 0.001".
std::string representation_of(const SurfaceCompliance& compliance);

}  // namespace palpate::stages
