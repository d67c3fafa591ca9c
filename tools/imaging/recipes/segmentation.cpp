// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/recipes/segmentation.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <optional>

#include "formats/model/errors.hpp"
#include "tools/imaging/files/image_files.hpp"
#include "tools/imaging/recipes/job.hpp"
#include "tools/imaging/voxels/hounsfield.hpp"

namespace palpate::imaging {
namespace {

void check_names(std::span<const StructureRecipe> structures) {
    std::map<std::string, int> seen;
    if (structures.empty())
        throw InvalidInput({"structures", "there are none", "1 or more", "add a structure"});
    if (structures.size() > 65535)
        throw InvalidInput({"structures", std::to_string(structures.size()), "65535 at most", ""});
    for (const StructureRecipe& structure : structures) {
        if (structure.name.empty())
            throw InvalidInput({"structure", "has no name", "", "name every structure"});
        if (++seen[structure.name] > 1)
            throw InvalidInput({"structure '" + structure.name + "'", "occurs twice", "",
                                "give each structure its own name"});
    }
}

// The label whose voxels a structure may take, besides background: that of the structure it lies inside.
std::int32_t replaced_label(const LabelMap& map, const StructureRecipe& structure,
                            const Parameters& parameters) {
    return parameters.has("inside")
               ? require_label(map, parameters.text("inside"), "structure '" + structure.name + "'").value
               : 0;
}

// A structure may take voxels of the one it lies inside, but not all of them.
void check_left_over(const LabelMap& map, std::int32_t replaced, const StructureRecipe& structure) {
    if (replaced == 0 || std::ranges::count(map.labels, replaced) > 0) return;
    const auto swallowed = std::ranges::find(map.names, replaced, &Label::value);
    throw InvalidInput({"structure '" + structure.name + "'",
                        "takes every voxel of '" + swallowed->name + "', which it lies inside",
                        "a part of them", "make it smaller, or leave '" + swallowed->name + "' larger"});
}

// The volume in HU: itself, or `shifted` if its values lie above.
const Volume* in_hounsfield(const Volume* volume, std::optional<Volume>& shifted, const NoteSink& note) {
    const double offset = volume ? hounsfield_offset(*volume) : 0;
    if (offset == 0) return volume;
    shifted = *volume;
    for (float& value : shifted->values) value -= static_cast<float>(offset);
    if (note)
        note(fmt::format(
            "no value of the volume is negative and soft tissue lies about {0}, so it is probably "
            "stored as HU + {0}: {0} was subtracted, and thresholds are in HU; give a volume in "
            "HU if that is wrong",
            offset));
    return &*shifted;
}

// A CT in other units, as in 8 bit, has values that recipes for HU would misread.
void check_unit(const Volume& volume, const Recipe& recipe, const std::string& culprit) {
    if (!recipe.needs_hu || is_ct(volume)) return;
    const auto scale = scale_by_air_and_soft_tissue(volume);
    if (!scale) return;
    const auto [low, high] = std::ranges::minmax(volume.values);
    throw InvalidInput({culprit,
                        fmt::format("recipe '{}' looks for HU, and the volume has values of {:g} to {:g}",
                                    recipe.name, low, high),
                        "a CT in HU",
                        fmt::format("by its air and soft tissue {}: if that is so, write scale = {:.4g} and "
                                    "offset = {:.4g} under [input], or give them to 'palpate import'",
                                    text_of(*scale), scale->scale, scale->offset)});
}

}  // namespace

LabelMap segment(const Volume* volume, const LabelMap* prior, std::span<const StructureRecipe> structures,
                 const ProgressCallback& progress, const NoteSink& note) {
    check_names(structures);
    for (const StructureRecipe& structure : structures) check_recipe(structure);
    if (volume == nullptr && prior == nullptr)
        throw InvalidInput({"segment", "neither a volume nor a label map", "one of them", ""});
    std::optional<Volume> shifted;
    const Volume* hounsfield = in_hounsfield(volume, shifted, note);
    LabelMap map;
    map.grid = volume ? volume->grid : prior->grid;
    map.labels.assign(map.grid.voxel_count(), 0);
    std::optional<LabelMap> grown;
    for (std::size_t n = 0; n < structures.size(); ++n) {
        const StructureRecipe& structure = structures[n];
        if (progress)
            progress(structure.name, static_cast<double>(n) / static_cast<double>(structures.size()));
        const Parameters parameters(structure);
        const Recipe& recipe = *find_recipe(structure.recipe);
        if (recipe.needs_volume && hounsfield == nullptr)
            throw InvalidInput({"structure '" + structure.name + "'",
                                "recipe '" + structure.recipe + "' has no volume to look at", "",
                                "name the volume, for CT with values in HU"});
        if (hounsfield != nullptr) check_unit(*hounsfield, recipe, "structure '" + structure.name + "'");
        const Job job{structure, parameters, structures, hounsfield, prior, map, note, grown};
        const Mask mask = cleaned(recipe.make(job), job);
        const std::int32_t replaced = replaced_label(map, structure, parameters);
        const auto value = static_cast<std::uint16_t>(n + 1);
        std::size_t taken = 0;
        for (std::size_t i = 0; i < map.labels.size(); ++i) {
            if (!mask.voxels[i] || (map.labels[i] != 0 && map.labels[i] != replaced)) continue;
            map.labels[i] = value;
            ++taken;
        }
        if (taken == 0) throw InvalidInput({job.culprit(), "is empty", "", recipe.if_empty});
        check_left_over(map, replaced, structure);
        const auto colour = recipe.colour ? recipe.colour(job) : std::nullopt;
        map.names.push_back({value, structure.name, colour.value_or(default_label_colour(value))});
    }
    return map;
}

}  // namespace palpate::imaging
