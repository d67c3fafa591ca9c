// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/segmentation.hpp"

#include <algorithm>
#include <optional>

#include "formats/model/errors.hpp"
#include "tools/imaging/image_files.hpp"
#include "tools/imaging/organ.hpp"
#include "tools/imaging/recipe_parameters.hpp"
#include "tools/imaging/recipes.hpp"

namespace palpate {
namespace {

constexpr double cubic_mm_per_ml = 1000;

// One structure with what its recipe may look at.
struct Job {
    const StructureRecipe& structure;
    const Parameters& parameters;
    const Volume* volume;
    const LabelMap* prior;
    const LabelMap& map;  // the structures made so far

    std::string culprit() const { return "structure '" + structure.name + "'"; }
    const Volume& require_volume() const;
};

const Volume& Job::require_volume() const {
    if (volume == nullptr)
        throw InvalidInput({culprit(), "recipe '" + structure.recipe + "' has no volume to look at", "",
                            "name the volume, for CT with values in HU"});
    return *volume;
}

Mask mask_of(const LabelMap& map, std::int32_t value) {
    Mask mask{map.grid, std::vector<std::uint8_t>(map.labels.size())};
    std::ranges::transform(map.labels, mask.voxels.begin(),
                           [&](std::uint16_t label) -> std::uint8_t { return label == value; });
    return mask;
}

Mask labelled(const LabelMap& map) {
    Mask mask{map.grid, std::vector<std::uint8_t>(map.labels.size())};
    std::ranges::transform(map.labels, mask.voxels.begin(),
                           [](std::uint16_t label) -> std::uint8_t { return label != 0; });
    return mask;
}

// The mask as seen from another grid: each voxel centre takes the value of the nearest voxel.
Mask resample(const Mask& mask, const ImageGrid& grid) {
    if (same_grid(mask.grid, grid)) return mask;
    Mask result{grid, std::vector<std::uint8_t>(grid.voxel_count(), 0)};
    std::size_t offset = 0;
    for (std::int32_t k = 0; k < grid.size[2]; ++k)
        for (std::int32_t j = 0; j < grid.size[1]; ++j)
            for (std::int32_t i = 0; i < grid.size[0]; ++i, ++offset) {
                const Eigen::Vector3d index =
                    mask.grid.index_of(grid.point_of(Eigen::Vector3d(i, j, k))).array().round();
                const Eigen::Vector3i nearest = index.cast<std::int32_t>();
                if (mask.grid.contains(nearest[0], nearest[1], nearest[2]))
                    result.voxels[offset] = mask.voxels[mask.grid.offset(nearest[0], nearest[1], nearest[2])];
            }
    return result;
}

Region region_of(const Parameters& parameters) {
    Region region;
    if (parameters.has("center_mm") || parameters.has("radius_mm"))
        region.sphere = {parameters.point("center_mm"), parameters.number("radius_mm")};
    if (parameters.has("box_min_mm") || parameters.has("box_max_mm"))
        region.box = {parameters.point("box_min_mm"), parameters.point("box_max_mm")};
    return region;
}

Mask clean(Mask mask, const Parameters& parameters) {
    mask = clip(mask, region_of(parameters));
    mask = close(mask, parameters.number("close_mm"));
    mask = open(mask, parameters.number("open_mm"));
    if (parameters.flag("fill_holes")) mask = fill_holes(mask);
    if (const double smallest = parameters.number("min_component_ml"); smallest > 0)
        mask = drop_small(mask, smallest * cubic_mm_per_ml);
    return parameters.flag("keep_largest") ? keep_largest(mask) : mask;
}

Mask make_bone(const Job& job) {
    const Parameters& p = job.parameters;
    return clean(bone(job.require_volume(), p.number("threshold_hu"), p.number("separation_mm")), p);
}

Mask make_airway(const Job& job) {
    const Parameters& p = job.parameters;
    return clean(
        airway(job.require_volume(), p.points("seeds_mm"), p.number("threshold_hu"), p.number("opening_mm")),
        p);
}

Mask make_liver(const Job& job) {
    const Parameters& p = job.parameters;
    return clean(organ(job.require_volume(), p.points("seeds_mm"), {}, job.culprit()), p);
}

Mask make_threshold(const Job& job) {
    const Parameters& p = job.parameters;
    return clean(threshold(job.require_volume(), p.number("lower_hu"), p.number("upper_hu")), p);
}

Mask make_nasopharynx(const Job& job) {
    const Parameters& p = job.parameters;
    const Label air = require_label(job.map, p.text("air"), job.culprit());
    return soft_wall(job.require_volume(), mask_of(job.map, air.value), labelled(job.map), region_of(p),
                     p.number("thickness_mm"), p.number("lower_hu"), p.number("upper_hu"),
                     p.number("smoothing_mm"));
}

Mask make_import(const Job& job) {
    const Parameters& p = job.parameters;
    std::optional<LabelMap> file;
    if (p.has("file")) file = read_label_map(p.text("file"));
    const LabelMap* source = file ? &*file : job.prior;
    if (source == nullptr)
        throw InvalidInput({job.culprit(), "there is no label map to import from", "",
                            "name one with file=... or beside the volume"});
    const Label label =
        require_label(*source, p.has("label") ? p.text("label") : job.structure.name, job.culprit());
    return clean(resample(mask_of(*source, label.value), job.map.grid), p);
}

Mask make_sphere(const Job& job) {
    const Parameters& p = job.parameters;
    const Label inside = require_label(job.map, p.text("inside"), job.culprit());
    return clip(mask_of(job.map, inside.value), {{{p.point("center_mm"), p.number("radius_mm")}}, {}});
}

struct Maker {
    Mask (*make)(const Job&);
    const char* if_empty;  // what to change
};

const std::map<std::string, Maker>& makers() {
    static const std::map<std::string, Maker> all{
        {"airway", {make_airway, "raise threshold_hu, lower opening_mm, or check region and cleaning"}},
        {"bone", {make_bone, "lower threshold_hu or min_component_ml; are the values in HU?"}},
        {"liver", {make_liver, "?"}},
        {"import", {make_import, "check that both images show the same place, or the region and cleaning"}},
        {"nasopharynx", {make_nasopharynx, "raise thickness_mm or move the region to the passage's wall"}},
        {"sphere", {make_sphere, "move center_mm into the structure named by 'inside', or raise radius_mm"}},
        {"threshold", {make_threshold, "widen lower_hu ... upper_hu, or check region and cleaning"}}};
    return all;
}

// An imported label keeps its colour.
std::array<float, 3> colour_of(const StructureRecipe& structure, const Parameters& p, const LabelMap* prior,
                               std::int32_t value) {
    if (structure.recipe == "import" && prior != nullptr && !p.has("file"))
        if (const auto label = find_label(*prior, p.has("label") ? p.text("label") : structure.name))
            return label->colour;
    return default_label_colour(value);
}

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

}  // namespace

LabelMap segment(const Volume* volume, const LabelMap* prior, std::span<const StructureRecipe> structures,
                 const ProgressCallback& progress) {
    check_names(structures);
    for (const StructureRecipe& structure : structures) check_recipe(structure);
    if (volume == nullptr && prior == nullptr)
        throw InvalidInput({"segment", "neither a volume nor a label map", "one of them", ""});
    LabelMap map;
    map.grid = volume ? volume->grid : prior->grid;
    map.labels.assign(map.grid.voxel_count(), 0);
    for (std::size_t n = 0; n < structures.size(); ++n) {
        const StructureRecipe& structure = structures[n];
        if (progress)
            progress(structure.name, static_cast<double>(n) / static_cast<double>(structures.size()));
        const Parameters parameters(structure);
        const Maker& maker = makers().at(structure.recipe);
        const Mask mask = maker.make({structure, parameters, volume, prior, map});
        const bool replaces = structure.recipe == "sphere";
        const auto value = static_cast<std::uint16_t>(n + 1);
        std::size_t taken = 0;
        for (std::size_t i = 0; i < map.labels.size(); ++i) {
            if (!mask.voxels[i] || (map.labels[i] != 0 && !replaces)) continue;
            map.labels[i] = value;
            ++taken;
        }
        if (taken == 0)
            throw InvalidInput({"structure '" + structure.name + "'", "is empty", "", maker.if_empty});
        map.names.push_back({value, structure.name, colour_of(structure, parameters, prior, value)});
    }
    return map;
}

}  // namespace palpate
