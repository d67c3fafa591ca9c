// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "formats/model/image_grid.hpp"
#include "formats/model/label_map.hpp"
#include "formats/model/progress.hpp"

namespace palpate {

/// A parameter as people write it: a number, numbers (a point x, y, z or several, flattened), a text, a flag.
using RecipeValue = std::variant<double, std::vector<double>, std::string, bool>;

/// How one structure is made; the command line, JSON recipes and case files all become this.
struct StructureRecipe {
    std::string name;                               ///< of the label it makes
    std::string recipe;                             ///< one of recipe_names()
    std::map<std::string, RecipeValue> parameters;  ///< by name; what is absent takes its default
};

/// What a recipe's parameter is.
struct RecipeParameterInfo {
    enum class Kind { number, numbers, text, flag };
    std::string name;
    Kind kind;
    std::string unit;           ///< "HU", "mm", "ml" or empty
    std::string default_value;  ///< as written; empty if there is none
    std::string meaning;
};

/// "airway", "bone", "import", "nasopharynx", "sphere", "threshold".
std::vector<std::string> recipe_names();

/// Lists the parameters of a recipe; throws InvalidInput with the nearest names if there is no such recipe.
std::vector<RecipeParameterInfo> recipe_parameters(const std::string& recipe);

/// Reads "skull: recipe=bone threshold_hu=226"; numbers of a point are separated by commas, points by
/// semicolons. Throws UsageError if the text is malformed, InvalidInput as check_recipe() does.
StructureRecipe parse_structure(std::string_view text);

/// Throws InvalidInput if the recipe or a parameter is unknown (with the nearest names), or of another kind.
void check_recipe(const StructureRecipe& structure);

/// Makes the structures in order, with label values 1, 2, 3 ... A structure takes background voxels only,
/// except a sphere, which takes voxels of the structure it lies inside. The result lies on the grid of
/// `volume` or, without one, of `prior`. `prior` is what the recipe "import" reads from, resampled to the
/// nearest voxel if its grid differs; either may be null.
/// Throws InvalidInput naming the structure if it would be empty, if a recipe misses the volume or the prior
/// it needs, if a label is not found, if a name occurs twice; and as check_recipe() does.
LabelMap segment(const Volume* volume, const LabelMap* prior, std::span<const StructureRecipe> structures,
                 const ProgressCallback& progress = {});

}  // namespace palpate
