// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/organs/organ.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "formats/model/errors.hpp"
#include "tools/imaging/organs/organ_seeds.hpp"
#include "tools/imaging/organs/random_walker.hpp"
#include "tools/imaging/voxels/coarse_grid.hpp"
#include "tools/imaging/voxels/filters.hpp"
#include "tools/imaging/voxels/necks.hpp"
#include "tools/imaging/voxels/seed_statistics.hpp"

namespace palpate::imaging {
namespace {

using Points = std::span<const Eigen::Vector3d>;

constexpr double block_mm = 2;           // fine enough for the shape, coarse enough for noise and time
constexpr double reach_mm = 200;         // further from the seeds no liver reaches
constexpr double seed_reach_mm = 10;     // a seed may lie in a vessel or a lesion
constexpr double smoothing_steps = 8;    // of the curvature flow, on blocks of block_mm
constexpr int most_smoothings = 4;       // so many times as many where noise asks for it
constexpr double muscle_hu = 50;         // and other organs without contrast
constexpr double faint_contrast = 10;    // HU: what ends an organ that is as grey as muscle differs so much
constexpr double bone_hu = 250;          // above vessels and kidneys in most contrast phases
constexpr double rib_gap = 20;           // mm: balls of this radius do not pass between two ribs
constexpr double first_edge_factor = 4;  // an edge is so much steeper than the surroundings of the seeds
constexpr double edge_factor = 3;        // and, later, than what was found, vessels and all
constexpr double least_edge = 1;         // HU per mm, for images without noise
constexpr double least_noise = 1;        // HU, likewise
constexpr double local_mm = 12;     // the local mean is taken over Gaussian surroundings of this deviation
constexpr double organ_neck = 0.4;  // of cut_at_necks()
constexpr double edge_mm = 4;       // edges are about this wide
constexpr double regained_mm = 3;   // thinner parts stay this far from thick ones
constexpr double border_mm = 5;     // the border is looked for this far either side of what was found
constexpr double around_mm = 4;     // deviation of the Gaussian surroundings that say what lies around
constexpr double trust_mm = 10;     // without an edge grey values decide over this length
constexpr int most_rounds = 8;
constexpr double settled = 0.01;  // share of voxels that a round may still add or lose

// What is looked at, block by block.
struct Blocks {
    Volume grey;    // within 200 HU of the seeds
    Volume smooth;  // the same without noise
    Mask wall;      // bone, the gaps between ribs, and what lies between them and any organ
    Volume steepness;
    double edge = 0;           // what is as steep is an edge, per mm
    std::vector<float> local;  // the organ's mean grey value around each block
};

Mask wall_of(const Volume& volume, double wall_mm) {
    Mask bone{volume.grid, std::vector<std::uint8_t>(volume.values.size())};
    std::ranges::transform(volume.values, bone.voxels.begin(), [](float v) { return v >= bone_hu; });
    return dilate(close(bone, rib_gap), wall_mm);
}

// Steps of the curvature flow that smooth over the same length: its square grows with steps and with that of
// a voxel's side.
int steps_on(const ImageGrid& grid) {
    const double side = std::cbrt(grid.voxel_volume());
    return std::max(1, static_cast<int>(std::lround(smoothing_steps * std::pow(block_mm / side, 2))));
}

// The gradient around each seed, and of those the median: single seeds lie near vessels or the border.
double inner_gradient(const Volume& steepness, Points seeds) {
    std::vector<float> gradients;
    for (const Eigen::Vector3d& seed : seeds) {
        std::vector<float> near = values_near(steepness, std::span(&seed, 1), seed_radius_mm);
        gradients.push_back(static_cast<float>(robust_statistics(near).mean));
    }
    return robust_statistics(gradients).mean;
}

// HU per mm: where the organ meets muscle, or is as grey. What noise makes an edge should not be steeper.
// Images that are not in HU come scaled to where it is steep.
double edge_to_muscle(const OrganSeeds& seeds) {
    return std::max(faint_contrast, std::abs(seeds.center - muscle_hu)) / edge_mm;
}

Blocks prepare(Volume grey, const OrganSeeds& seeds, double wall_mm, int smoothings) {
    Mask wall = wall_of(grey, wall_mm);
    for (float& value : grey.values)
        value =
            std::clamp(value, static_cast<float>(seeds.center - 200), static_cast<float>(seeds.center + 200));
    const int steps = steps_on(grey.grid);
    Volume smooth = grey, steepness = grey;
    double edge = INFINITY;
    for (int done = 0; edge > edge_to_muscle(seeds) && done < smoothings * steps;) {
        const int more = done == 0 ? steps : std::max(1, steps / 2);
        smooth = curvature_flow(smooth, more);
        steepness = gradient_length(smooth, block_mm * 0.75);
        edge = std::max(least_edge, first_edge_factor * inner_gradient(steepness, seeds.points));
        done += more;
    }
    std::vector<float> local(smooth.values.size());
    for_each_voxel(smooth.grid, [&](std::int32_t i, std::int32_t j, std::int32_t k, std::size_t offset) {
        local[offset] =
            static_cast<float>(expected_at(seeds, smooth.grid.point_of(Eigen::Vector3d(i, j, k))));
    });
    return {std::move(grey), std::move(smooth), std::move(wall), std::move(steepness), edge,
            std::move(local)};
}

// The pieces of a mask that are nearest to a seed, at most `reach` (mm) away.
Mask pieces_at(const Mask& mask, Points seeds, double reach) {
    const Components pieces = components_of(mask);
    std::vector<std::uint8_t> seeded(pieces.sizes.size() + 1, 0);
    for (const Eigen::Vector3d& seed : seeds)
        if (const auto voxel = nearest_voxel(mask, seed, reach)) seeded[pieces.labels[*voxel]] = 1;
    return select(mask, pieces, [&](std::uint32_t n) { return seeded[n] != 0; });
}

double median_within(const Mask& mask, const Volume& volume) {
    std::vector<float> values;
    for (std::size_t i = 0; i < mask.voxels.size(); ++i)
        if (mask.voxels[i]) values.push_back(volume.values[i]);
    return robust_statistics(values).mean;
}

// What of the candidates hangs together with the seeds through necks that a ball of `neck_mm` passes.
Mask thick_part(const Mask& candidates, Points seeds, double neck_mm) {
    const std::vector<float> depth = depth_in(candidates);
    std::vector<std::size_t> inside;
    for (const Eigen::Vector3d& seed : seeds)
        if (const auto voxel = nearest_voxel(candidates, seed, seed_reach_mm)) inside.push_back(*voxel);
    if (inside.empty()) return {candidates.grid, std::vector<std::uint8_t>(candidates.voxels.size(), 0)};
    const Mask cut = cut_at_necks(candidates, depth, inside, organ_neck);
    Mask core = cut;
    for (std::size_t i = 0; i < core.voxels.size(); ++i)
        core.voxels[i] = cut.voxels[i] && depth[i] >= neck_mm;
    core = pieces_at(core, seeds, 3 * seed_reach_mm);
    return intersect(dilate(core, neck_mm + regained_mm), cut);
}

// Voxels near the local mean and not in the wall, with or without edges.
Mask candidates_of(const Blocks& blocks, double tolerance_hu, bool with_edges) {
    Mask mask = blocks.wall;
    for (std::size_t i = 0; i < mask.voxels.size(); ++i)
        mask.voxels[i] = !blocks.wall.voxels[i] && (with_edges || blocks.steepness.values[i] < blocks.edge) &&
                         std::abs(blocks.smooth.values[i] - blocks.local[i]) <= tolerance_hu;
    return mask;
}

Mask found_in(const Blocks& blocks, const OrganSeeds& seeds, const OrganParameters& p) {
    const Mask thick = thick_part(candidates_of(blocks, p.tolerance_hu, false), seeds.points, p.neck_mm);
    return intersect(dilate(thick, edge_mm), candidates_of(blocks, p.tolerance_hu, true));
}

// The mean of what was found, around each block; where little was found, what the seeds say. It varies slowly
// and is worked out on a coarser grid.
void follow(Blocks& blocks, const Mask& found, const OrganSeeds& seeds, double drift_hu) {
    constexpr float doubt = 0.1F;  // weight of the seeds' word
    const auto center = static_cast<float>(seeds.center), drift = static_cast<float>(drift_hu);
    Volume share{found.grid, {found.voxels.begin(), found.voxels.end()}}, sum = share;
    for (std::size_t i = 0; i < sum.values.size(); ++i) sum.values[i] *= blocks.smooth.values[i] - center;
    const auto step = blocks_of(found.grid, local_mm / 3);
    sum = coarsen(sum, step);
    share = coarsen(share, step);
    gaussian(sum.grid, sum.values, local_mm);
    gaussian(share.grid, share.values, local_mm);
    Volume mean = sum;
    for_each_voxel(mean.grid, [&](std::int32_t i, std::int32_t j, std::int32_t k, std::size_t offset) {
        const auto expected =
            static_cast<float>(expected_at(seeds, mean.grid.point_of(Eigen::Vector3d(i, j, k)))) - center;
        const float off = (sum.values[offset] + doubt * expected) / (share.values[offset] + doubt);
        mean.values[offset] = center + std::clamp(off, expected - drift, expected + drift);
    });
    for_each_voxel(found.grid, [&](std::int32_t i, std::int32_t j, std::int32_t k, std::size_t offset) {
        blocks.local[offset] = mean.values[mean.grid.offset(i / step[0], j / step[1], k / step[2])];
    });
}

// How probably each voxel is of the organ, by its grey value between the organ's local mean and that of what
// lies around, both with the noise of what was found: half way between the two, as a voxel is that lies half
// in either, it is one half.
std::vector<float> chances_by_grey(const Mask& found, const std::vector<float>& distance,
                                   const Blocks& blocks, double noise) {
    constexpr float least_share = 1e-3F;  // of what lies around; further inside there is none
    Volume share{found.grid, std::vector<float>(distance.size())}, mean = blocks.grey;
    for (std::size_t i = 0; i < distance.size(); ++i) {
        share.values[i] = double{distance[i]} > found.grid.spacing.maxCoeff() ? 1 : 0;  // clear of the border
        mean.values[i] *= share.values[i];
    }
    gaussian(found.grid, share.values, around_mm);
    gaussian(found.grid, mean.values, around_mm);
    std::vector<float> chances(distance.size());
    for (std::size_t i = 0; i < chances.size(); ++i) {
        if (share.values[i] < least_share) {
            chances[i] = 1;
            continue;
        }
        const double grey = double{blocks.grey.values[i]},
                     off_organ = (grey - double{blocks.local[i]}) / noise,
                     around = double{mean.values[i]} / double{share.values[i]},
                     off_around = (grey - around) / noise;
        chances[i] =
            static_cast<float>(1 / (1 + std::exp((off_organ * off_organ - off_around * off_around) / 2)));
    }
    return chances;
}

// What was found, its border put by a random walker where grey values change.
Mask with_border(const Mask& found, const Blocks& blocks) {
    const std::vector<float> depth = depth_in(found), distance = distance_to(found);
    std::vector<float> off;
    for (std::size_t i = 0; i < found.voxels.size(); ++i)
        if (found.voxels[i]) off.push_back(blocks.grey.values[i] - blocks.local[i]);
    const double noise = std::max(least_noise, robust_statistics(off).sigma);
    Mask inside = found, outside = blocks.wall;
    for (std::size_t i = 0; i < found.voxels.size(); ++i) {
        inside.voxels[i] = double{depth[i]} > border_mm;
        if (double{distance[i]} > border_mm) outside.voxels[i] = 1;
    }
    return random_walk(blocks.grey, {.inside = std::move(inside),
                                     .outside = std::move(outside),
                                     .prior = chances_by_grey(found, distance, blocks, noise),
                                     .noise = noise,
                                     .trust_mm = trust_mm});
}

Mask organ_of_blocks(Volume grey, const OrganSeeds& seeds, const OrganParameters& p, int smoothings) {
    Blocks blocks = prepare(std::move(grey), seeds, p.wall_mm, smoothings);
    Mask found = found_in(blocks, seeds, p);
    follow(blocks, found, seeds, p.drift_hu);
    for (int round = 1; round < most_rounds; ++round) {
        const auto before = static_cast<double>(found.count());
        blocks.edge = std::max(least_edge, edge_factor * median_within(found, blocks.steepness));
        found = found_in(blocks, seeds, p);
        follow(blocks, found, seeds, p.drift_hu);
        if (std::abs(static_cast<double>(found.count()) - before) < settled * before) break;
    }
    found = fill_holes(close(pieces_at(found, seeds.points, seed_reach_mm), p.gap_mm));
    return pieces_at(fill_holes(with_border(found, blocks)), seeds.points, seed_reach_mm);
}

// The blocks that are not air and at most reach_mm from the seeds' box.
Box box_around(const Volume& blocks, Points seeds) {
    const ImageGrid& grid = blocks.grid;
    Eigen::Array3d low = Eigen::Array3d::Constant(INFINITY), high = -low;
    for (const Eigen::Vector3d& seed : seeds) {
        low = low.min(grid.index_of(seed).array());
        high = high.max(grid.index_of(seed).array());
    }
    low -= reach_mm / grid.spacing.array();
    high += reach_mm / grid.spacing.array();
    Eigen::Array3i first = Eigen::Array3i::Constant(INT32_MAX), last = -first;
    for_each_voxel(grid, [&](std::int32_t i, std::int32_t j, std::int32_t k, std::size_t offset) {
        const Eigen::Array3i at(i, j, k);
        if (blocks.values[offset] < -200 || (at.cast<double>() < low).any() ||
            (at.cast<double>() > high).any())
            return;
        first = first.min(at);
        last = last.max(at);
    });
    return {{first[0], first[1], first[2]},
            {last[0] - first[0] + 1, last[1] - first[1] + 1, last[2] - first[2] + 1}};
}

}  // namespace

Mask organ(const Volume& volume, Points seeds, const OrganParameters& parameters, const std::string& culprit,
           const std::function<void(std::string_view)>& note) {
    if (seeds.empty())
        throw InvalidInput(
            {culprit, "has no seed", "1 to 5 points inside it", "add seeds=x,y,z;... or seeds_file=..."});
    for (const Eigen::Vector3d& seed : seeds) voxel_of_seed(volume.grid, seed, culprit);
    const auto block = blocks_of(volume.grid, block_mm);
    Volume whole = coarsen(volume, block);
    const OrganSeeds looked_at = look_at_seeds(whole, seeds, parameters, culprit, note);
    const Box box = box_around(whole, seeds);
    whole = crop(whole, box);
    Mask found = organ_of_blocks(whole, looked_at, parameters, most_smoothings);
    // What is small is smoothed away.
    if (found.count() == 0) found = organ_of_blocks(std::move(whole), looked_at, parameters, 1);
    if (found.count() == 0)
        throw InvalidInput(
            {culprit, fmt::format("no piece as thick as {} mm holds a seed", 2 * parameters.neck_mm), "",
             "move the seeds away from the organ's border, lower neck_mm or raise tolerance_hu"});
    return refine(found, box.low, block, volume.grid);
}

}  // namespace palpate::imaging
