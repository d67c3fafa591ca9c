// SPDX-License-Identifier: GPL-3.0-or-later
// For this folder only: how each recipe makes its structure.
#pragma once
#include <optional>
#include <span>
#include <string>

#include "tools/imaging/recipes/recipe_parameters.hpp"
#include "tools/imaging/recipes/segmentation.hpp"
#include "tools/imaging/voxels/mask.hpp"

namespace palpate {

/// One structure with what its recipe may look at.
struct Job {
    const StructureRecipe& structure;
    const Parameters& parameters;
    std::span<const StructureRecipe> all;  ///< the structures of this run
    const Volume* volume;                  ///< in HU
    const LabelMap* prior;
    const LabelMap& map;  ///< the structures made so far
    const NoteSink& note;
    std::optional<LabelMap>& grown;  ///< what the structures of grow-from-seeds share, once made

    std::string culprit() const { return "structure '" + structure.name + "'"; }
    /// Throws InvalidInput if there is none.
    const Volume& require_volume() const;
};

/// Runs the job's recipe and its cleaning steps. Throws as segment() does.
Mask make_structure(const Job& job);

/// What to change if a recipe found nothing.
std::string advice_if_empty(const std::string& recipe);

}  // namespace palpate
