// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/recipes/recipe.hpp"

#include <algorithm>

#include "tools/imaging/recipes/recipe_list.hpp"

namespace palpate {

std::string range_text(RecipeParameter::Range range) {
    switch (range) {
        case RecipeParameter::Range::any:
            return "a number";
        case RecipeParameter::Range::finite:
            return "a finite number";
        case RecipeParameter::Range::not_negative:
            return "0 or more";
        case RecipeParameter::Range::positive:
            break;
    }
    return "above 0";
}

const std::vector<Recipe>& recipes() {
    static const std::vector<Recipe> all = registered_recipes();
    return all;
}

const Recipe* find_recipe(const std::string& name) {
    const auto found = std::ranges::find(recipes(), name, &Recipe::name);
    return found == recipes().end() ? nullptr : &*found;
}

const RecipeParameter* find_parameter(const Recipe& recipe, const std::string& name) {
    const auto found = std::ranges::find(recipe.parameters, name, &RecipeParameter::name);
    return found == recipe.parameters.end() ? nullptr : &*found;
}

}  // namespace palpate
