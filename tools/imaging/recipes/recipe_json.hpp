// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "tools/imaging/recipes/segmentation.hpp"

namespace palpate::imaging {

/// A parameter's value from JSON; arrays of points are flattened. Throws InvalidInput naming `culprit` for
/// anything but a number, numbers, a text, true or false.
RecipeValue recipe_value(const nlohmann::ordered_json& value, const std::string& culprit);

/// How a structure is made, from its name, its recipe's and its parameters as a JSON object. Throws
/// as recipe_value() does, naming `culprit` and the parameter.
StructureRecipe structure_recipe(const std::string& name, const std::string& recipe,
                                 const nlohmann::ordered_json& parameters, const std::string& culprit);

/// Reads a recipe file: [{"name": ..., "recipe": ..., "parameters": {...}}, ...]. Throws InvalidInput if it
/// is none, has an unknown key, more than 16 MiB, or is nested more than 32 deep.
std::vector<StructureRecipe> read_recipe_file(const std::filesystem::path& path);

}  // namespace palpate::imaging
