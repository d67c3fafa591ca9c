// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/voxels/grow_from_seeds.hpp"

#include <array>
#include <fmt/format.h>
#include <set>

#include "formats/model/errors.hpp"
#include "tools/imaging/recipes/job.hpp"

namespace palpate::imaging {
namespace {

constexpr std::size_t all_strokes = 20'000;

// All structures of this recipe compete, and so does what else their files hold, as background.
LabelMap race(const Job& job) {
    std::vector<Seed> seeds, others;
    GrowParameters growing;
    for (const StructureRecipe& structure : job.all) {
        if (structure.recipe != job.structure.recipe) continue;
        const Parameters parameters(structure);
        growing.tolerances[structure.name] = parameters.number("tolerance");
        const NamedSeeds found = named_seeds(parameters, structure.name, all_strokes);
        if (found.own.empty())
            throw InvalidInput({"structure '" + structure.name + "'", "has no seed",
                                "1 or more points inside it",
                                "add seeds=x,y,z;..., seeds_file=... or scribbles=..."});
        seeds.insert(seeds.end(), found.own.begin(), found.own.end());
        others.insert(others.end(), found.all.begin(), found.all.end());
        for (const Eigen::Vector3d& point : parameters.points("background_mm"))
            others.push_back({"background", point});
    }
    const auto place = [](const Seed& seed) { return std::array{seed.p_P[0], seed.p_P[1], seed.p_P[2]}; };
    std::set<std::array<double, 3>> claimed;
    for (const Seed& seed : seeds) claimed.insert(place(seed));
    for (const Seed& seed : others)
        if (claimed.insert(place(seed)).second) seeds.push_back({"background", seed.p_P});
    return grow_from_seeds(*job.volume, seeds, growing);
}

Mask make_grown(const Job& job) {
    if (!job.grown) job.grown = race(job);
    return mask_of(*job.grown, require_label(*job.grown, job.structure.name, job.culprit()).value);
}

}  // namespace

Recipe grow_from_seeds_recipe() {
    using enum RecipeParameter::Kind;
    return {.name = "grow-from-seeds",
            .meaning =
                "what grows from its seeds; structures of this recipe compete with each other, and "
                "points and strokes of other names in their files compete as background",
            .parameters =
                concatenated({{{"tolerance", number, "", fmt::format("{}", GrowParameters{}.tolerance),
                                "it stops at grey values so many standard deviations off its seeds' mean",
                                RecipeParameter::Range::positive},
                               {"background_mm", points, "mm", "", "points x, y, z outside it (LPS)"}},
                              seed_parameters(all_strokes),
                              region_parameters(),
                              cleaning_parameters()}),
            .if_empty = "raise tolerance, move the seeds, or check the cleaning",
            .make = make_grown,
            .needs_volume = true,
            .needs_seeds = true};
}

}  // namespace palpate::imaging
