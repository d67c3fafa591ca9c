// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "tools/imaging/recipes/segmentation.hpp"

namespace palpate::imaging {

/// A parameter's value from JSON; arrays of points are flattened. Throws InvalidInput naming `culprit` for
/// anything but a number, numbers, a text, true or false.
RecipeValue recipe_value(const nlohmann::ordered_json& value, const std::string& culprit);

}  // namespace palpate::imaging
