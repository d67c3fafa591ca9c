// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/recipes/job.hpp"
#include "tools/imaging/recipes/recipe_list.hpp"

namespace palpate::imaging {

Recipe brain_recipe() {
    Recipe recipe = import_recipe();
    recipe.name = "brain";
    recipe.meaning = "a brain of a label map that was made before, in one piece without holes";
    recipe.parameters = with_defaults(recipe.parameters, {{"fill_holes", "yes"}, {"keep_largest", "yes"}});
    return recipe;
}

}  // namespace palpate::imaging
