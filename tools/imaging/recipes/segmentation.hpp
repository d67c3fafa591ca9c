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
#include "tools/imaging/files/image_files.hpp"

namespace palpate::imaging {

/// A parameter as people write it: a number, numbers (a point x, y, z or several, flattened), a text, a flag.
using RecipeValue = std::variant<double, std::vector<double>, std::string, bool>;

/// How one structure is made; the command line, JSON recipes and case files all become this.
struct StructureRecipe {
    std::string name;                               ///< of the label it makes
    std::string recipe;                             ///< the name of one of recipes()
    std::map<std::string, RecipeValue> parameters;  ///< by name; what is absent takes its default
    std::vector<std::string> order = {};  ///< parameters as written, for cleaning steps; may be empty
};

/// Reads "skull: recipe=bone threshold_hu=226"; numbers of a point are separated by commas, points by
/// semicolons; "seeds" is short for "seeds_mm". Throws UsageError if the text is malformed or the name not
/// UTF-8, InvalidInput as check_recipe() does.
StructureRecipe parse_structure(std::string_view text);

/// Throws InvalidInput if the recipe or a parameter is unknown (with the nearest names), or of another kind,
/// or if a number is out of the parameter's range, a coordinate not finite.
void check_recipe(const StructureRecipe& structure);

/// Makes the structures in order, with label values 1, 2, 3 ... A structure takes background voxels only,
/// except one with a parameter "inside", which takes voxels of the structure that it names. Cleaning steps
/// follow the recipe in the order written. The result lies on the grid of `volume` or, without one, of
/// `prior`. `prior` is what recipes import from, resampled to the nearest voxel if its grid differs; either
/// may be null. A CT stored above HU is shifted where hounsfield_offset() can tell by how much. `note`
/// receives that, and what else a person should look at, one sentence at a time.
/// Throws InvalidInput naming the structure if it would be empty or implausibly large or would leave nothing
/// of the structure it lies inside, if a recipe misses the volume, the prior or the seeds it needs, if a seed
/// or a label is not where it must be, if a name occurs twice; as check_recipe() and read_seeds() do.
LabelMap segment(const Volume* volume, const LabelMap* prior, std::span<const StructureRecipe> structures,
                 const ProgressCallback& progress = {}, const NoteSink& note = {});

}  // namespace palpate::imaging
