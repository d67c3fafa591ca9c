// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/recipes/recipe.hpp"

#include <algorithm>

#include "tools/imaging/recipes/recipe_list.hpp"

namespace palpate::imaging {

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

bool is_file_parameter(const std::string& name) {
    return std::ranges::any_of(recipes(), [&](const Recipe& recipe) {
        const RecipeParameter* parameter = find_parameter(recipe, name);
        return parameter != nullptr && parameter->kind == RecipeParameter::Kind::file;
    });
}

}  // namespace palpate::imaging
