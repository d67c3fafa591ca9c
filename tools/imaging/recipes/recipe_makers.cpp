// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/recipes/recipe_makers.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <optional>
#include <set>

#include "formats/model/errors.hpp"
#include "tools/imaging/recipes/organ.hpp"
#include "tools/imaging/recipes/recipes.hpp"
#include "tools/imaging/voxels/grow_from_seeds.hpp"
#include "tools/imaging/voxels/inside_organ.hpp"
#include "tools/imaging/voxels/seeds.hpp"

namespace palpate {
namespace {

constexpr double cubic_mm_per_ml = 1000;

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

// The region first, then the cleaning steps in their order.
Mask clean(Mask mask, const Job& job) {
    const Parameters& p = job.parameters;
    mask = clip(mask, region_of(p));
    for (const std::string& step : cleaning_steps(job.structure)) {
        if (step == "close_mm") mask = close(mask, p.number(step));
        if (step == "open_mm") mask = open(mask, p.number(step));
        if (step == "smooth_mm") mask = smooth(mask, p.number(step));
        if (step == "fill_holes" && p.flag(step)) mask = fill_holes(mask);
        if (step == "keep_largest" && p.flag(step)) mask = keep_largest(mask);
        if (step == "min_component_ml" && p.number(step) > 0)
            mask = drop_small(mask, p.number(step) * cubic_mm_per_ml);
    }
    return mask;
}

// Centres of the strokes of each label, as seeds; at most `limit` of a label, evenly chosen.
std::vector<Seed> seeds_of_strokes(const LabelMap& strokes, std::size_t limit) {
    std::vector<Seed> seeds;
    const auto& size = strokes.grid.size;
    for (const Label& label : strokes.names) {
        std::vector<Eigen::Vector3d> points;
        std::size_t offset = 0;
        for (std::int32_t k = 0; k < size[2]; ++k)
            for (std::int32_t j = 0; j < size[1]; ++j)
                for (std::int32_t i = 0; i < size[0]; ++i, ++offset)
                    if (strokes.labels[offset] == label.value)
                        points.push_back(strokes.grid.point_of(Eigen::Vector3d(i, j, k)));
        const std::size_t stride = (points.size() + limit - 1) / limit;
        for (std::size_t n = 0; n < points.size(); n += stride) seeds.push_back({label.name, points[n]});
    }
    return seeds;
}

struct NamedSeeds {
    std::vector<Seed> own, all;  // of the structure; whatever the same files hold
};

NamedSeeds seeds_for(const Parameters& p, const std::string& name, const std::string& culprit,
                     std::size_t limit) {
    NamedSeeds seeds;
    for (const Eigen::Vector3d& point : p.points("seeds_mm")) seeds.own.push_back({name, point});
    const auto add = [&](const std::vector<Seed>& from) {
        for (const Seed& seed : seeds_of(from, name, culprit)) seeds.own.push_back({name, seed.p_P});
        seeds.all.insert(seeds.all.end(), from.begin(), from.end());
    };
    if (p.has("seeds_file")) add(read_seeds(p.text("seeds_file")));
    if (p.has("scribbles")) add(seeds_of_strokes(read_label_map(p.text("scribbles")), limit));
    return seeds;
}

std::vector<Eigen::Vector3d> points_for(const Job& job) {
    constexpr std::size_t enough = 25;
    std::vector<Eigen::Vector3d> points;
    for (const Seed& seed : seeds_for(job.parameters, job.structure.name, job.culprit(), enough).own)
        points.push_back(seed.p_P);
    return points;
}

Mask make_bone(const Job& job) {
    const Parameters& p = job.parameters;
    double threshold_hu = p.number("threshold_hu");
    if (threshold_hu == 0) {
        threshold_hu = bone_threshold(job.require_volume());
        if (job.note) job.note(fmt::format("{}: threshold {:.0f} HU found", job.culprit(), threshold_hu));
    }
    return bone(job.require_volume(), threshold_hu, p.number("separation_mm"));
}

Mask make_airway(const Job& job) {
    const Parameters& p = job.parameters;
    return airway(job.require_volume(), points_for(job), p.number("threshold_hu"), p.number("opening_mm"),
                  job.culprit());
}

Mask make_threshold(const Job& job) {
    const Parameters& p = job.parameters;
    return threshold(job.require_volume(), p.number("lower_hu"), p.number("upper_hu"));
}

Mask make_nasopharynx(const Job& job) {
    const Parameters& p = job.parameters;
    const Label air = require_label(job.map, p.text("air"), job.culprit());
    return soft_wall(job.require_volume(), mask_of(job.map, air.value), labelled(job.map), region_of(p),
                     p.number("thickness_mm"), p.number("lower_hu"), p.number("upper_hu"),
                     p.number("smoothing_mm"));
}

Mask make_liver(const Job& job) {
    const Parameters& p = job.parameters;
    OrganParameters parameters;
    parameters.tolerance_hu = p.number("tolerance_hu");
    parameters.drift_hu = p.number("drift_hu");
    parameters.neck_mm = p.number("neck_mm");
    parameters.gap_mm = p.number("gap_mm");
    const Mask mask =
        clip(organ(job.require_volume(), points_for(job), parameters, job.culprit(), job.note), region_of(p));
    const double ml = static_cast<double>(mask.count()) * mask.grid.voxel_volume() / cubic_mm_per_ml;
    if (ml > p.number("largest_ml"))
        throw InvalidInput(
            {job.culprit(), fmt::format("has {:.0f} ml: it ran into its neighbours", ml),
             fmt::format("{:.0f} ml at most", p.number("largest_ml")),
             "lower tolerance_hu or raise neck_mm, cut it to a region (center_mm, radius_mm), or "
             "use recipe=grow-from-seeds with points labelled 'background'"});
    return mask;
}

Mask make_tumour(const Job& job) {
    const Parameters& p = job.parameters;
    const Label organ = require_label(job.map, p.text("inside"), job.culprit());
    return lesion(job.require_volume(), mask_of(job.map, organ.value), points_for(job), p.number("margin_mm"),
                  job.culprit());
}

Mask make_vessels(const Job& job) {
    const Parameters& p = job.parameters;
    std::optional<Mask> inside;
    if (p.has("inside"))
        inside = mask_of(job.map, require_label(job.map, p.text("inside"), job.culprit()).value);
    return vessels(job.require_volume(), inside ? &*inside : nullptr, points_for(job),
                   p.number("contrast_hu"), p.number("max_radius_mm"), job.culprit());
}

// All structures of this recipe compete, and so does what else their files hold, as background.
LabelMap race(const Job& job) {
    constexpr std::size_t all_strokes = 20'000;
    std::vector<Seed> seeds, others;
    GrowParameters growing;
    for (const StructureRecipe& structure : job.all) {
        if (structure.recipe != job.structure.recipe) continue;
        const Parameters parameters(structure);
        growing.tolerances[structure.name] = parameters.number("tolerance");
        const NamedSeeds found =
            seeds_for(parameters, structure.name, "structure '" + structure.name + "'", all_strokes);
        if (found.own.empty())
            throw InvalidInput({"structure '" + structure.name + "'", "has no seed",
                                "1 or more points inside it",
                                "add seeds=x,y,z;..., seeds_file=... or scribbles=..."});
        seeds.insert(seeds.end(), found.own.begin(), found.own.end());
        others.insert(others.end(), found.all.begin(), found.all.end());
    }
    const auto place = [](const Seed& seed) { return std::array{seed.p_P[0], seed.p_P[1], seed.p_P[2]}; };
    std::set<std::array<double, 3>> claimed;
    for (const Seed& seed : seeds) claimed.insert(place(seed));
    for (const Seed& seed : others)
        if (claimed.insert(place(seed)).second) seeds.push_back({"background", seed.p_P});
    return grow_from_seeds(job.require_volume(), seeds, growing);
}

Mask make_grown(const Job& job) {
    if (!job.grown) job.grown = race(job);
    return mask_of(*job.grown, require_label(*job.grown, job.structure.name, job.culprit()).value);
}

Mask make_import(const Job& job) {
    const Parameters& p = job.parameters;
    std::optional<LabelMap> file;
    if (p.has("file")) file = read_label_map(p.text("file"));
    const LabelMap* source = file ? &*file : job.prior;
    if (source == nullptr)
        throw InvalidInput({job.culprit(), "there is no label map to import from", "",
                            "name one with file=... or beside the volume"});
    const std::string name = p.has("label") ? p.text("label") : job.structure.name;
    if (name == "*") return resample(labelled(*source), job.map.grid);
    return resample(mask_of(*source, require_label(*source, name, job.culprit()).value), job.map.grid);
}

Mask make_sphere(const Job& job) {
    const Parameters& p = job.parameters;
    const Label inside = require_label(job.map, p.text("inside"), job.culprit());
    return clip(mask_of(job.map, inside.value), {{{p.point("center_mm"), p.number("radius_mm")}}, {}});
}

struct Maker {
    Mask (*make)(const Job&);
    bool cleaned;
    const char* if_empty;  // what to change
};

const Maker& maker_of(const std::string& recipe) {
    const char* elsewhere = "check that both images show the same place, or the region and cleaning";
    static const std::map<std::string, Maker> all{
        {"airway", {make_airway, true, "raise threshold_hu, lower opening_mm, or check region and cleaning"}},
        {"bone", {make_bone, true, "lower threshold_hu or min_component_ml; are the values in HU?"}},
        {"brain", {make_import, true, elsewhere}},
        {"grow-from-seeds", {make_grown, true, "raise tolerance, move the seeds, or check the cleaning"}},
        {"import", {make_import, true, elsewhere}},
        {"liver", {make_liver, true, "move the seeds into the liver, or check region and cleaning"}},
        {"nasopharynx",
         {make_nasopharynx, false, "raise thickness_mm or move the region to the passage's wall"}},
        {"sphere",
         {make_sphere, false, "move center_mm into the structure named by 'inside', or raise radius_mm"}},
        {"threshold", {make_threshold, true, "widen lower_hu ... upper_hu, or check region and cleaning"}},
        {"tumour", {make_tumour, true, "move the seeds, raise margin_mm, or check region and cleaning"}},
        {"vessels", {make_vessels, true, "lower contrast_hu or min_component_ml, or raise max_radius_mm"}}};
    return all.at(recipe);
}

}  // namespace

const Volume& Job::require_volume() const {
    if (volume == nullptr)
        throw InvalidInput({culprit(), "recipe '" + structure.recipe + "' has no volume to look at", "",
                            "name the volume, for CT with values in HU"});
    return *volume;
}

Mask make_structure(const Job& job) {
    const Maker& maker = maker_of(job.structure.recipe);
    Mask mask = maker.make(job);
    return maker.cleaned ? clean(std::move(mask), job) : mask;
}

std::string advice_if_empty(const std::string& recipe) {
    return maker_of(recipe).if_empty;
}

}  // namespace palpate
