// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "formats/model/errors.hpp"
#include "tools/imaging/recipes/job.hpp"
#include "tools/imaging/voxels/coarse_grid.hpp"
#include "tools/imaging/voxels/filters.hpp"
#include "tools/imaging/voxels/necks.hpp"
#include "tools/imaging/voxels/seed_statistics.hpp"

namespace palpate::imaging {
namespace {

constexpr double least_contrast = 1.5;  // standard deviations
constexpr double least_difference = 5;  // HU
constexpr double narrow_neck = 0.5;     // of cut_at_necks()

// Voxels of the organ, of its holes and within `margin_mm` of it whose smoothed grey value is nearer to that
// within 3 mm of the seeds (p_P, mm) than to the organ's median, cut at necks so that the lesion does not run
// out along vessels or the border.
Mask lesion(const Volume& volume, const Mask& organ, std::span<const Eigen::Vector3d> seeds, double margin_mm,
            const std::string& culprit) {
    if (seeds.empty())
        throw InvalidInput(
            {culprit, "has no seed", "1 or more points inside it", "add seeds=x,y,z or seeds_file=..."});
    for (const Eigen::Vector3d& seed : seeds) voxel_of_seed(volume.grid, seed, culprit);
    const Box box = bounding_box(organ, margin_mm + 5);
    const Mask part = crop(organ, box);
    const Mask region = fill_holes(dilate(part, margin_mm));
    voxels_at(region, seeds, culprit,
              fmt::format("a point within {} mm of the organ", margin_mm + seed_miss_mm),
              "move it, or name the organ that holds it with 'inside'");
    const Volume grey = curvature_flow(crop(volume, box), 4);
    std::vector<float> values;
    for (std::size_t i = 0; i < part.voxels.size(); ++i)
        if (part.voxels[i]) values.push_back(grey.values[i]);
    const GreyStatistics around = robust_statistics(values);
    values = values_near(grey, seeds, 3);
    const double mean = robust_statistics(values).mean, difference = mean - around.mean;
    if (std::abs(difference) < std::max(least_contrast * around.sigma, least_difference))
        throw InvalidInput({culprit,
                            fmt::format("around the seeds it is {:.0f} HU, in the organ {:.0f} +- {:.0f} HU",
                                        mean, around.mean, around.sigma),
                            "a difference of 1.5 deviations and 5 HU or more",
                            "move the seeds into the lesion, or draw it with recipe=sphere or scribbles"});
    Mask candidates = region;
    for (std::size_t i = 0; i < candidates.voxels.size(); ++i)
        candidates.voxels[i] =
            region.voxels[i] && (grey.values[i] - around.mean - difference / 2) * difference > 0;
    const auto inside = voxels_at(candidates, seeds, culprit, "the grey values of the other seeds",
                                  "leave that seed out or make it a structure of its own");
    return refine(cut_at_necks(candidates, depth_in(candidates), inside, narrow_neck), box.low, {1, 1, 1},
                  organ.grid);
}

Mask make_tumour(const Job& job) {
    const Mask organ = job.structure_named_by("inside");
    return lesion(*job.volume, organ, seed_points(job), job.parameters.number("margin_mm"), job.culprit());
}

}  // namespace

Recipe tumour_recipe() {
    using enum RecipeParameter::Kind;
    return {.name = "tumour",
            .meaning = "a lesion in an organ, darker or brighter than it, in one piece without holes",
            .parameters = concatenated(
                {{{"inside", structure, "", "", "structure whose voxels it takes"},
                  {"margin_mm", number, "mm", "2", "how far it may reach beyond the voxels of that structure",
                   RecipeParameter::Range::not_negative}},
                 seed_parameters(),
                 region_parameters(),
                 with_defaults(cleaning_parameters(), {{"fill_holes", "yes"}, {"keep_largest", "yes"}})}),
            .if_empty = "move the seeds, raise margin_mm, or check region and cleaning",
            .make = make_tumour,
            .needs_volume = true,
            .needs_hu = true,
            .needs_seeds = true};
}

}  // namespace palpate::imaging
