// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/draft/scan_draft.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sstream>

#include "formats/model/errors.hpp"
#include "formats/toml_file/quoted.hpp"
#include "tools/imaging/recipes/segmentation.hpp"
#include "tools/imaging/voxels/seeds.hpp"

namespace palpate::draft {
namespace {

using imaging::RecipeValue;
using imaging::StructureRecipe;

std::string toml_value(const RecipeValue& value) {
    if (const auto* text = std::get_if<std::string>(&value)) return toml_file::quoted(*text);
    if (const auto* flag = std::get_if<bool>(&value)) return *flag ? "true" : "false";
    if (const auto* number = std::get_if<double>(&value)) return fmt::format("{}", *number);
    return fmt::format("[{}]", fmt::join(std::get<std::vector<double>>(value), ", "));
}

// As a case file has it, parameters in the order in which they were written.
std::string toml_lines(const StructureRecipe& structure, const std::string& seeds_file) {
    std::string lines = fmt::format("recipe = {}\n", toml_file::quoted(structure.recipe));
    for (const std::string& name : structure.order)
        if (name != "recipe")
            lines +=
                fmt::format("{} = {}\n", name,
                            name == "seeds_file" ? seeds_file : toml_value(structure.parameters.at(name)));
    return lines;
}

// The structure that is clicked into, with its seeds.
StructureRecipe seeded(const ScanRecipes& recipes, const ScanSeeds& seeds) {
    const std::string start = recipes.clicked + ":";
    const std::string text = *std::ranges::find_if(
        recipes.structures, [&](const std::string& structure) { return structure.starts_with(start); });
    StructureRecipe structure = imaging::parse_structure(with_points(text, seeds.inside, seeds.outside));
    if (seeds.file.empty()) return structure;
    structure.parameters["seeds_file"] = seeds.file.string();
    structure.order.emplace_back("seeds_file");
    return structure;
}

Eigen::Vector3d first_seed(const StructureRecipe& structure, const ScanSeeds& seeds) {
    if (const auto found = structure.parameters.find("seeds_mm"); found != structure.parameters.end())
        return Eigen::Vector3d::Map(std::get<std::vector<double>>(found->second).data());
    return imaging::seeds_of(imaging::read_seeds(seeds.file), structure.name, seeds.file.string())
        .front()
        .p_P;
}

// The text of each point without its blanks.
std::string joined(const std::vector<std::string>& points) {
    std::string text = fmt::format("{}", fmt::join(points, ";"));
    std::erase_if(text, [](unsigned char c) { return std::isspace(c) != 0; });
    return text;
}

bool has_background(const ScanSeeds& seeds) {
    if (!seeds.outside.empty()) return true;
    if (seeds.file.empty()) return false;
    const std::vector<imaging::Seed> found = imaging::read_seeds(seeds.file);
    return std::ranges::find(found, "background", &imaging::Seed::label) != found.end();
}

}  // namespace

void check_point(const std::string& text, const std::string& option) {
    std::istringstream stream(text);
    int numbers = 0;
    bool good = !text.ends_with(',');
    for (std::string part; std::getline(stream, part, ','); ++numbers) {
        char* end = nullptr;
        good = good && std::isfinite(std::strtod(part.c_str(), &end)) && end != part.c_str() &&
               std::string_view(end).find_first_not_of(' ') == std::string_view::npos;
    }
    if (!good || numbers != 3)
        throw UsageError({option, "'" + text + "'", "x,y,z (LPS, mm)", "repeat the option for more points"});
}

std::string with_points(std::string structure, const std::vector<std::string>& inside,
                        const std::vector<std::string>& outside) {
    if (!inside.empty()) structure += " seeds_mm=" + joined(inside);
    if (!outside.empty()) structure += " background_mm=" + joined(outside);
    return structure;
}

CaseDraft draft_scan(const Volume& volume, bool ct, const ScanSeeds& seeds, const Wishes& wishes,
                     const std::string& culprit, const ProgressCallback& progress,
                     const imaging::NoteSink& note) {
    const bool against_background = has_background(seeds);
    const auto recipes_for = [&](const Eigen::Vector3d& seed) {
        return scan_recipes(wishes.organ, ct, against_background, seed);
    };
    const StructureRecipe clicked = seeded(recipes_for(Eigen::Vector3d::Zero()), seeds);
    const ScanRecipes recipes = recipes_for(first_seed(clicked, seeds));
    std::vector<StructureRecipe> structures;
    for (const std::string& text : recipes.structures)
        structures.push_back(text.starts_with(recipes.clicked + ":") ? clicked
                                                                     : imaging::parse_structure(text));
    Wishes found_wishes = wishes;
    found_wishes.organ = recipes.organ;
    CaseDraft draft =
        draft_case(imaging::segment(&volume, nullptr, structures, progress, note), found_wishes, culprit);
    const std::string why = std::ranges::find(draft.structures, recipes.organ, &DraftStructure::name)->why;
    draft.structures.clear();
    for (const StructureRecipe& structure : structures)
        draft.structures.push_back({structure.name,
                                    structure.name == recipes.organ ? why : "needed to find it",
                                    toml_lines(structure, seeds.file_in_case)});
    draft.rigid.clear();
    for (const std::string& label : recipes.rigid) draft.rigid.push_back({label, true});
    if (!recipes.tissue.empty()) draft.regions.front().tissue = recipes.tissue;
    if (recipes.tool_radius > 0) draft.tool_radius = recipes.tool_radius;
    if (!recipes.held_by.empty()) {
        draft.held_by = recipes.held_by;
        draft.why_held = fmt::format("what touches {}", fmt::join(recipes.held_by, " or "));
    }
    return draft;
}

}  // namespace palpate::draft
