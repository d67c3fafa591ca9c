// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <fmt/format.h>
#include <functional>
#include <span>

#include "formats/model/errors.hpp"
#include "tools/imaging/organs/organ.hpp"
#include "tools/imaging/recipes/job.hpp"

namespace palpate::imaging {
namespace {

constexpr double apart_mm = 10;  // capsule and rim between a lesion and the tissue around it

// The liver with the lesions around `seeds` (p_P, mm), each found as an organ of its own grey value.
Mask with_lesions(const Mask& liver, const Job& job, std::span<const Eigen::Vector3d> seeds,
                  const OrganParameters& parameters) {
    Mask all = liver;
    for (const Eigen::Vector3d& seed : seeds) {
        const auto refused = [&](const std::string& why, const std::string& expected) {
            return InvalidInput(
                {job.culprit(),
                 fmt::format("the lesion at {:.1f}, {:.1f}, {:.1f} mm {}", seed[0], seed[1], seed[2], why),
                 expected, "move the point deeper into a lesion of the liver, or lower tolerance_hu"});
        };
        const Mask lesion =
            organ(*job.volume, std::span(&seed, 1), parameters, job.culprit() + ", lesion", job.note);
        if (subtract(lesion, liver).count() > liver.count())
            throw refused("ran out of it into its neighbours", "less than the liver without it");
        if (intersect(dilate(lesion, apart_mm), liver).count() == 0)
            throw refused("lies apart from it", fmt::format("at most {} mm between them", apart_mm));
        std::ranges::transform(all.voxels, lesion.voxels, all.voxels.begin(), std::bit_or<std::uint8_t>());
    }
    return seeds.empty() ? liver : fill_holes(close(all, parameters.gap_mm));
}

Mask make_liver(const Job& job) {
    const Parameters& p = job.parameters;
    const OrganParameters parameters{.tolerance_hu = p.number("tolerance_hu"),
                                     .drift_hu = p.number("drift_hu"),
                                     .neck_mm = p.number("neck_mm"),
                                     .gap_mm = p.number("gap_mm")};
    const Mask found = organ(*job.volume, few_seed_points(job), parameters, job.culprit(), job.note);
    const Mask mask = clip(with_lesions(found, job, p.points("lesion_seeds_mm"), parameters), region_of(p));
    const double ml = static_cast<double>(mask.count()) * mask.grid.voxel_volume() / cubic_mm_per_ml;
    if (ml > p.number("largest_ml"))
        throw InvalidInput(
            {job.culprit(), fmt::format("has {:.0f} ml: it ran into its neighbours", ml),
             fmt::format("{:.0f} ml at most", p.number("largest_ml")),
             "lower tolerance_hu or raise neck_mm, cut it to a region (center_mm, radius_mm), or "
             "use recipe=grow-from-seeds with points labelled 'background'"});
    return mask;
}

}  // namespace

Recipe liver_recipe() {
    using enum RecipeParameter::Kind;
    using enum RecipeParameter::Range;
    return {
        .name = "liver",
        .meaning = "the liver in CT, with contrast or without, from one to five seeds inside it",
        .parameters = concatenated(
            {{{"tolerance_hu", number, "HU", "25", "grey values may be so far off the local mean", positive},
              {"drift_hu", number, "HU", "20", "the local mean may be so far off that at the seeds",
               not_negative},
              {"neck_mm", number, "mm", "6", "where no ball of this radius passes, the liver ends",
               not_negative},
              {"gap_mm", number, "mm", "4", "vessels, lesions and clefts below this radius are filled",
               not_negative},
              {"lesion_seeds_mm", points, "mm", "",
               "points x, y, z in lesions that reach its border, one in each (LPS); they become part of it"},
              {"largest_ml", number, "ml", "4000", "more than this is a leak", not_negative}},
             seed_parameters(),
             region_parameters(),
             with_defaults(cleaning_parameters(), {{"smooth_mm", "3"}})}),
        .if_empty = "move the seeds into the liver, or check region and cleaning",
        .make = make_liver,
        .needs_volume = true,
        .needs_hu = true,
        .needs_seeds = true};
}

}  // namespace palpate::imaging
