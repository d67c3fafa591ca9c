// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "formats/model/errors.hpp"
#include "tools/imaging/recipes/job.hpp"
#include "tools/imaging/voxels/coarse_grid.hpp"
#include "tools/imaging/voxels/filters.hpp"
#include "tools/imaging/voxels/seed_statistics.hpp"

namespace palpate::imaging {
namespace {

constexpr double noise_mm = 1;  // deviation of the Gaussian that smooths it

// Bright tubes: voxels at least `contrast_hu` above the Gaussian mean of their surroundings (deviation 2
// max_radius_mm, within `inside` or, where that is empty, within everything above -200), without what a ball
// of `max_radius_mm` fits into and without what is more than 150 HU brighter than the seeds (bone). Kept are
// the pieces that hold seeds (p_P, mm) or, without seeds, all.
Mask vessels(const Volume& volume, const Mask* inside, std::span<const Eigen::Vector3d> seeds,
             double contrast_hu, double max_radius_mm, const std::string& culprit) {
    constexpr double brighter_is_bone = 150;
    if (inside == nullptr && seeds.empty())
        throw InvalidInput({culprit, "has neither 'inside' nor a seed", "one of them",
                            "name the organ with inside=..., or give points in the vessels"});
    for (const Eigen::Vector3d& seed : seeds) voxel_of_seed(volume.grid, seed, culprit);
    const Box box = inside ? bounding_box(*inside, max_radius_mm) : Box{{0, 0, 0}, volume.grid.size};
    const Mask region = inside ? fill_holes(crop(*inside, box)) : Mask();
    Volume grey = crop(volume, box);
    gaussian(grey.grid, grey.values, noise_mm);
    const std::size_t count = grey.values.size();
    std::vector<float> around(count), weights(count);
    for (std::size_t i = 0; i < count; ++i) {
        weights[i] = inside ? region.voxels[i] : grey.values[i] > -200;
        around[i] = weights[i] * grey.values[i];
    }
    gaussian(grey.grid, around, 2 * max_radius_mm);
    gaussian(grey.grid, weights, 2 * max_radius_mm);
    double highest = INFINITY;
    if (!seeds.empty()) {
        std::vector<float> near = values_near(grey, seeds, grey.grid.spacing.minCoeff());
        highest = robust_statistics(near).mean + brighter_is_bone;
    }
    Mask bright{grey.grid, std::vector<std::uint8_t>(count)};
    for (std::size_t i = 0; i < count; ++i)
        bright.voxels[i] = (!inside || region.voxels[i]) && weights[i] > 0 && grey.values[i] <= highest &&
                           grey.values[i] - around[i] / weights[i] >= contrast_hu;
    Mask tubes = subtract(bright, open(bright, max_radius_mm));
    if (!seeds.empty()) {
        const Components pieces = components_of(tubes);
        std::set<std::uint32_t> seeded;
        for (const std::size_t voxel :
             voxels_at(tubes, seeds, culprit, "a bright tube",
                       "move it into a vessel, lower contrast_hu or raise max_radius_mm"))
            seeded.insert(pieces.labels[voxel]);
        tubes = select(tubes, pieces, [&](std::uint32_t n) { return seeded.contains(n); });
    }
    return refine(tubes, box.low, {1, 1, 1}, volume.grid);
}

Mask make_vessels(const Job& job) {
    const Parameters& p = job.parameters;
    std::optional<Mask> inside;
    if (p.has("inside")) inside = job.structure_named_by("inside");
    return vessels(*job.volume, inside ? &*inside : nullptr, seed_points(job), p.number("contrast_hu"),
                   p.number("max_radius_mm"), job.culprit());
}

}  // namespace

Recipe vessels_recipe() {
    using enum RecipeParameter::Kind;
    using enum RecipeParameter::Range;
    return {
        .name = "vessels",
        .meaning = "bright tubes in an organ, or those that hold a seed",
        .parameters = concatenated(
            {{{"inside", structure, "", "", "structure whose voxels they take [default: background only]"},
              {"contrast_hu", number, "HU", "25", "they are so much brighter than their surroundings",
               not_negative},
              {"max_radius_mm", number, "mm", "8", "what a larger ball fits into is no vessel",
               not_negative}},
             seed_parameters(),
             region_parameters(),
             with_defaults(cleaning_parameters(), {{"min_component_ml", "0.05"}})}),
        .if_empty = "lower contrast_hu or min_component_ml, or raise max_radius_mm",
        .make = make_vessels,
        .needs_volume = true,
        .needs_hu = true};
}

}  // namespace palpate::imaging
