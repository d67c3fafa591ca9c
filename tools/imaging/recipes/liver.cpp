// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "formats/model/errors.hpp"
#include "tools/imaging/recipes/job.hpp"
#include "tools/imaging/voxels/organ.hpp"

namespace palpate::imaging {
namespace {

Mask make_liver(const Job& job) {
    const Parameters& p = job.parameters;
    const OrganParameters parameters{.tolerance_hu = p.number("tolerance_hu"),
                                     .drift_hu = p.number("drift_hu"),
                                     .neck_mm = p.number("neck_mm"),
                                     .gap_mm = p.number("gap_mm")};
    const Mask mask =
        clip(organ(*job.volume, seed_points(job), parameters, job.culprit(), job.note), region_of(p));
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
              {"largest_ml", number, "ml", "4000", "more than this is a leak", not_negative}},
             seed_parameters(),
             region_parameters(),
             with_defaults(cleaning_parameters(), {{"smooth_mm", "3"}})}),
        .if_empty = "move the seeds into the liver, or check region and cleaning",
        .make = make_liver,
        .needs_volume = true,
        .needs_seeds = true};
}

}  // namespace palpate::imaging
