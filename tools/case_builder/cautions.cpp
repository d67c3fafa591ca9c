// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/case_builder/cautions.hpp"

#include <algorithm>
#include <fmt/format.h>

#include "tools/imaging/recipes/recipe.hpp"
#include "tools/imaging/voxels/hounsfield.hpp"
#include "tools/tissue/tissue.hpp"

namespace palpate::case_builder {
namespace {

constexpr double least_tool_mm = 0.2, most_tool_mm = 30;  // radius: from a needle to a fist

std::string source_of(const DeformableSpec& body, const stages::LabelMaterial& material) {
    const auto found = std::ranges::find(body.tissues, material.label, &RegionTissue::label);
    if (found == body.tissues.end())
        return fmt::format(
            "'{}': {:g} kPa and Poisson's ratio {:g} are the case file's, which names no source.",
            material.label, material.youngs_modulus_kpa, material.poissons_ratio);
    const tissue::Tissue& tissue = tissue::require_tissue(found->tissue, material.label);
    const bool own = material.youngs_modulus_kpa != tissue.youngs_modulus_kpa ||
                     material.poissons_ratio != tissue.poissons_ratio;
    return own ? fmt::format(
                     "'{}': {:g} kPa and Poisson's ratio {:g} are the case file's; the rest is that of "
                     "the preset '{}'. {}",
                     material.label, material.youngs_modulus_kpa, material.poissons_ratio, tissue.name,
                     tissue.source)
               : fmt::format("'{}': values of the preset '{}', {}. {}", material.label, tissue.name,
                             tissue.meaning, tissue.source);
}

void doubt_modulus(const DeformableSpec& body, const stages::LabelMaterial& material,
                   std::vector<std::string>& doubts) {
    const auto found = std::ranges::find(body.tissues, material.label, &RegionTissue::label);
    double least = tissue::least_soft_kpa, most = tissue::most_soft_kpa;
    std::string what = "soft tissue";
    if (found != body.tissues.end()) {
        const tissue::Tissue& tissue = tissue::require_tissue(found->tissue, material.label);
        least = tissue.least_kpa;
        most = tissue.most_kpa;
        what = tissue.name;
    }
    const double modulus = material.youngs_modulus_kpa;
    if (modulus < least || modulus > most)
        doubts.push_back(
            fmt::format("'{}': {:g} kPa is implausible; {} has {:g} to {:g} kPa. Is the unit right?",
                        material.label, modulus, what, least, most));
}

}  // namespace

std::vector<std::string> doubts_of(const CaseFile& case_file) {
    std::vector<std::string> doubts;
    for (const DeformableSpec& body : case_file.deformable)
        for (const stages::LabelMaterial& material : body.condense.materials)
            doubt_modulus(body, material, doubts);
    const double radius = case_file.haptics.tool_radius;
    if (radius < least_tool_mm || radius > most_tool_mm)
        doubts.push_back(
            fmt::format("A tool of {:g} mm radius is implausible; tools have {:g} to {:g} mm. Is the "
                        "unit right?",
                        radius, least_tool_mm, most_tool_mm));
    return doubts;
}

std::vector<std::string> cautions_of(const CaseFile& case_file) {
    std::vector<std::string> cautions = doubts_of(case_file);
    const imaging::HounsfieldScale scale{case_file.volume_import.scale, case_file.volume_import.offset};
    if (scale != imaging::HounsfieldScale{})
        cautions.push_back(
            fmt::format("{} is the case file's, which names no source; where 'init' found it by air and "
                        "soft tissue, it is some 4 % off.",
                        imaging::text_of(scale)));
    for (const StructureSpec& structure : case_file.structures)
        if (const imaging::Recipe* recipe = imaging::find_recipe(structure.recipe);
            recipe != nullptr && recipe->makes_up)
            cautions.push_back(
                fmt::format("'{}' is made up, {}: no image shows it.", structure.name, recipe->meaning));
    for (const DeformableSpec& body : case_file.deformable)
        for (const stages::LabelMaterial& material : body.condense.materials)
            cautions.push_back(source_of(body, material));
    return cautions;
}

}  // namespace palpate::case_builder
