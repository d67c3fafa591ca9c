// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "tools/imaging/voxels/mask.hpp"

namespace palpate::imaging {

/// A parameter of a recipe, as people write it.
struct RecipeParameter {
    /// `point` is x, y, z and `points` are several (LPS, mm); `file` is the path of a file that is read,
    /// `structure` the name of a structure that was made before.
    enum class Kind { number, point, points, text, file, structure, flag };
    /// Which numbers are allowed; coordinates are always finite.
    enum class Range { any, finite, not_negative, positive };
    std::string name;
    Kind kind;
    std::string unit;           ///< "HU", "mm", "ml" or empty
    std::string default_value;  ///< as written; empty if there is none
    std::string meaning;        ///< one clause
    Range range = Range::finite;
};

using RecipeParameters = std::vector<RecipeParameter>;

/// "a number", "a finite number", "0 or more" or "above 0".
std::string range_text(RecipeParameter::Range range);

struct Job;

/// A way to make a structure. Each is one file of this folder, recipes/<name>.cpp, that defines
/// `Recipe <name>_recipe()`; the list in tools/imaging/CMakeLists.txt registers it, and everything else that
/// speaks of recipes visits recipes().
struct Recipe {
    std::string name;
    std::string meaning;          ///< what it makes, one sentence without its full stop
    RecipeParameters parameters;  ///< its own, then those it shares with others
    std::string if_empty;         ///< what to change if it finds nothing
    /// Makes the mask, before region and cleaning steps. Throws InvalidInput naming the structure.
    Mask (*make)(const Job&) = nullptr;
    /// The colour of the label that it takes over; where it gives none, a default one is taken.
    std::optional<std::array<float, 3>> (*colour)(const Job&) = nullptr;
    bool needs_volume = false;  ///< grey values to look at
    bool needs_hu = false;      ///< of a CT: its numbers mean nothing on another scale
    bool needs_seeds = false;   ///< one at least
    bool makes_up = false;      ///< what it makes is not in the image
};

/// All recipes, by name in alphabetical order.
const std::vector<Recipe>& recipes();

/// The recipe of that name, null if there is none.
const Recipe* find_recipe(const std::string& name);

/// The parameter of that name, null if the recipe has none.
const RecipeParameter* find_parameter(const Recipe& recipe, const std::string& name);

/// Tells whether a parameter of that name, of whatever recipe, is the path of a file that is read.
bool is_file_parameter(const std::string& name);

/// The parameters of the cleaning steps that follow most recipes, in the order in which they apply where none
/// is written.
RecipeParameters cleaning_parameters();

}  // namespace palpate::imaging
