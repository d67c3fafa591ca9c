// SPDX-License-Identifier: GPL-3.0-or-later
// Which parameters each recipe has.
#include <algorithm>
#include <array>
#include <fmt/format.h>

#include "formats/model/errors.hpp"
#include "tools/imaging/recipes/recipe_parameters.hpp"

namespace palpate {
namespace {

using Kind = RecipeParameterInfo::Kind;
using Table = std::map<std::string, std::vector<RecipeParameterInfo>>;

std::vector<RecipeParameterInfo> region_parameters() {
    return {{"center_mm", Kind::numbers, "mm", "", "centre x, y, z of the sphere it is cut to"},
            {"radius_mm", Kind::number, "mm", "", "radius of that sphere"},
            {"box_min_mm", Kind::numbers, "mm", "", "lowest x, y, z of the box it is cut to"},
            {"box_max_mm", Kind::numbers, "mm", "", "highest x, y, z of that box"}};
}

std::vector<RecipeParameterInfo> seed_parameters() {
    return {{"seeds_mm", Kind::numbers, "mm", "", "points x, y, z inside it (LPS); 'seeds' for short"},
            {"seeds_file", Kind::text, "", "",
             "3D Slicer points (.mrk.json, .fcsv): those labelled as the structure, or all if they share a "
             "label"},
            {"scribbles", Kind::text, "", "", "label map with strokes, those labelled as the structure"}};
}

// Applied in the order written, after the recipe; in this order where none is known.
std::vector<RecipeParameterInfo> cleaning_parameters(const std::string& smallest_ml = "0",
                                                     const std::string& solid = "no",
                                                     const std::string& smooth_mm = "0") {
    return {{"close_mm", Kind::number, "mm", "0", "fill gaps that a ball of this radius does not fit into"},
            {"open_mm", Kind::number, "mm", "0", "remove what a ball of this radius does not fit into"},
            {"fill_holes", Kind::flag, "", solid, "fill enclosed background"},
            {"min_component_ml", Kind::number, "ml", smallest_ml, "drop smaller pieces"},
            {"keep_largest", Kind::flag, "", solid, "keep the largest piece only"},
            {"smooth_mm", Kind::number, "mm", smooth_mm, "round details below this size off, volume kept"}};
}

const std::vector<RecipeParameterInfo> import_parameters{
    {"label", Kind::text, "", "",
     "name or value in the label map, * for all of them [default: the structure's name]"},
    {"file", Kind::text, "", "", "label map to read [default: the one given with the volume]"}};

Table own_parameters() {
    return {
        {"bone",
         {{"threshold_hu", Kind::number, "HU", "226", "bone is at least this dense; 0 finds it by itself"},
          {"separation_mm", Kind::number, "mm", "4", "ball that cuts table and head rest off the body"}}},
        {"airway",
         {{"threshold_hu", Kind::number, "HU", "-400", "air is below"},
          {"opening_mm", Kind::number, "mm", "5",
           "openings to the outside that a ball of this radius does not pass count as closed"}}},
        {"nasopharynx",
         {{"air", Kind::text, "", "airway", "structure the wall encloses"},
          {"thickness_mm", Kind::number, "mm", "6", "depth of the wall from the air"},
          {"lower_hu", Kind::number, "HU", "-400", "soft tissue is at least this dense"},
          {"upper_hu", Kind::number, "HU", "225", "soft tissue is at most this dense"},
          {"smoothing_mm", Kind::number, "mm", "1", "gaps and spikes below this radius vanish"}}},
        {"liver",
         {{"tolerance_hu", Kind::number, "HU", "25", "grey values may be so far off the local mean"},
          {"drift_hu", Kind::number, "HU", "20", "the local mean may be so far off that at the seeds"},
          {"neck_mm", Kind::number, "mm", "6", "where no ball of this radius passes, the liver ends"},
          {"gap_mm", Kind::number, "mm", "4", "vessels, lesions and clefts below this radius are filled"},
          {"largest_ml", Kind::number, "ml", "4000", "more than this is a leak"}}},
        {"tumour",
         {{"inside", Kind::text, "", "", "structure whose voxels it takes"},
          {"margin_mm", Kind::number, "mm", "2",
           "how far it may reach beyond the voxels of that structure"}}},
        {"vessels",
         {{"inside", Kind::text, "", "", "structure whose voxels they take [default: background only]"},
          {"contrast_hu", Kind::number, "HU", "25", "they are so much brighter than their surroundings"},
          {"max_radius_mm", Kind::number, "mm", "8", "what a larger ball fits into is no vessel"}}},
        {"grow-from-seeds",
         {{"tolerance", Kind::number, "", "3",
           "it stops at grey values so many standard deviations off its seeds' mean"}}},
        {"threshold",
         {{"lower_hu", Kind::number, "HU", "-inf", "lowest value"},
          {"upper_hu", Kind::number, "HU", "inf", "highest value"}}},
        {"import", import_parameters},
        {"brain", import_parameters},
        {"sphere",
         {{"inside", Kind::text, "", "", "structure whose voxels it takes"},
          {"center_mm", Kind::numbers, "mm", "", "centre x, y, z"},
          {"radius_mm", Kind::number, "mm", "", "radius"}}}};
}

Table make_table() {
    const auto append = [](std::vector<RecipeParameterInfo>& to,
                           const std::vector<RecipeParameterInfo>& more) {
        to.insert(to.end(), more.begin(), more.end());
    };
    Table table = own_parameters();
    for (auto& [recipe, parameters] : table) {
        if (recipe == "sphere") continue;
        if (takes_seeds(recipe)) append(parameters, seed_parameters());
        append(parameters, region_parameters());
        if (recipe == "nasopharynx") continue;
        const bool solid = recipe == "brain" || recipe == "tumour";
        append(parameters, cleaning_parameters(recipe == "bone"      ? "1"
                                               : recipe == "vessels" ? "0.05"
                                                                     : "0",
                                               solid ? "yes" : "no", recipe == "liver" ? "3" : "0"));
    }
    return table;
}

const Table& table() {
    static const Table recipes = make_table();
    return recipes;
}

}  // namespace

bool takes_seeds(const std::string& recipe) {
    return std::ranges::count(std::array{"airway", "grow-from-seeds", "liver", "tumour", "vessels"}, recipe) >
           0;
}

std::vector<std::string> cleaning_steps(const StructureRecipe& structure) {
    std::vector<std::string> steps, written;
    for (const RecipeParameterInfo& info : cleaning_parameters())
        if (std::ranges::count(structure.order, info.name) == 0) steps.push_back(info.name);
    for (const std::string& name : structure.order)
        if (std::ranges::count(steps, name) == 0 &&
            std::ranges::count(cleaning_parameters(), name, &RecipeParameterInfo::name) > 0)
            written.push_back(name);
    steps.insert(steps.end(), written.begin(), written.end());
    return steps;
}

std::vector<std::string> recipe_names() {
    std::vector<std::string> names;
    for (const auto& [name, parameters] : table()) names.push_back(name);
    return names;
}

std::vector<RecipeParameterInfo> recipe_parameters(const std::string& recipe) {
    const auto found = table().find(recipe);
    if (found == table().end())
        throw InvalidInput(
            {"recipe", "'" + recipe + "' is unknown", "",
             fmt::format("nearest names: '{}'", fmt::join(nearest_names(recipe, recipe_names()), "', '"))});
    return found->second;
}

}  // namespace palpate
