// SPDX-License-Identifier: GPL-3.0-or-later
// For this folder only: what a recipe is given to work with, and the parameters that recipes share.
#pragma once
#include <initializer_list>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tools/imaging/recipes/recipe.hpp"
#include "tools/imaging/recipes/recipe_parameters.hpp"
#include "tools/imaging/recipes/segmentation.hpp"
#include "tools/imaging/voxels/mask.hpp"
#include "tools/imaging/voxels/seeds.hpp"

namespace palpate::imaging {

constexpr double cubic_mm_per_ml = 1000;

/// One structure with what its recipe may look at.
struct Job {
    const StructureRecipe& structure;
    const Parameters& parameters;
    std::span<const StructureRecipe> all;  ///< the structures of this run
    const Volume* volume;                  ///< in HU; there is one where the recipe needs it
    const LabelMap* prior;
    const LabelMap& map;  ///< the structures made so far
    const NoteSink& note;
    std::optional<LabelMap>& grown;  ///< what the structures of grow-from-seeds share, once made

    std::string culprit() const { return "structure '" + structure.name + "'"; }
    /// The voxels of the structure that the parameter names; throws InvalidInput if the parameter is absent
    /// or no such structure was made before.
    Mask structure_named_by(const std::string& parameter) const;
};

RecipeParameters concatenated(std::initializer_list<RecipeParameters> lists);
/// The same parameters with other defaults, by name; throws std::out_of_range if one is not among them.
RecipeParameters with_defaults(RecipeParameters parameters,
                               const std::map<std::string, std::string>& defaults);

/// center_mm and radius_mm, box_min_mm and box_max_mm: what the mask is cut to.
RecipeParameters region_parameters();
/// The region that those parameters describe; all of space without them.
Region region_of(const Parameters& parameters);

constexpr std::size_t few_strokes = 25;  ///< enough for grey values and places

/// seeds_mm, seeds_file and scribbles; of each label's strokes at most `most_strokes` voxels are taken.
RecipeParameters seed_parameters(std::size_t most_strokes = few_strokes);

struct NamedSeeds {
    std::vector<Seed> own;  ///< of the structure
    std::vector<Seed> all;  ///< whatever the same files hold
};

/// The seeds that those parameters give a structure. Throws InvalidInput as read_seeds(), read_label_map()
/// and seeds_of() do.
NamedSeeds named_seeds(const Parameters& parameters, const std::string& structure,
                       std::size_t most_strokes = few_strokes);
/// Their places alone (p_P, mm).
std::vector<Eigen::Vector3d> seed_points(const Job& job);
/// The same for a recipe that looks around each seed: throws InvalidInput for more than 5 of seeds_mm and
/// seeds_file; strokes are thinned to few_strokes.
std::vector<Eigen::Vector3d> few_seed_points(const Job& job);

/// Cuts the mask to the job's region and applies the cleaning steps that its recipe has: those not written
/// first, then as written.
Mask cleaned(Mask mask, const Job& job);

}  // namespace palpate::imaging
