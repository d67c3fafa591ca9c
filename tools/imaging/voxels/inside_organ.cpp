// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/voxels/inside_organ.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <set>

#include "formats/model/errors.hpp"
#include "tools/imaging/voxels/coarse_grid.hpp"
#include "tools/imaging/voxels/filters.hpp"
#include "tools/imaging/voxels/necks.hpp"
#include "tools/imaging/voxels/seed_statistics.hpp"

namespace palpate {
namespace {

using Points = std::span<const Eigen::Vector3d>;

constexpr double lesion_seed_reach = 3;  // mm: a seed may miss by a voxel or two
constexpr double least_contrast = 1.5;   // standard deviations
constexpr double least_difference = 5;   // HU
constexpr double noise_mm = 1;           // deviation of the Gaussian that smooths it
constexpr double narrow_neck = 0.5;      // of cut_at_necks()

// The offset of the voxel of the mask nearest to each seed.
std::vector<std::size_t> voxels_at(const Mask& mask, Points seeds, const std::string& culprit,
                                   const std::string& expected, const std::string& next_step) {
    std::vector<std::size_t> found;
    for (const Eigen::Vector3d& seed : seeds) {
        const auto voxel = nearest_voxel(mask, seed, lesion_seed_reach);
        if (!voxel)
            throw InvalidInput({culprit, "seed " + point_text(seed) + " is not there", expected, next_step});
        found.push_back(*voxel);
    }
    return found;
}

}  // namespace

Mask lesion(const Volume& volume, const Mask& organ, Points seeds, double margin_mm,
            const std::string& culprit) {
    if (seeds.empty())
        throw InvalidInput(
            {culprit, "has no seed", "1 or more points inside it", "add seeds=x,y,z or seeds_file=..."});
    for (const Eigen::Vector3d& seed : seeds) voxel_of_seed(volume.grid, seed, culprit);
    const Box box = bounding_box(organ, margin_mm + 5);
    const Mask part = crop(organ, box);
    const Mask region = fill_holes(dilate(part, margin_mm));
    voxels_at(region, seeds, culprit,
              fmt::format("a point within {} mm of the organ", margin_mm + lesion_seed_reach),
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

Mask vessels(const Volume& volume, const Mask* inside, Points seeds, double contrast_hu, double max_radius_mm,
             const std::string& culprit) {
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

}  // namespace palpate
