// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <fmt/format.h>

#include "tools/imaging/recipes/job.hpp"
#include "tools/imaging/voxels/hounsfield.hpp"
#include "tools/imaging/voxels/seed_statistics.hpp"

namespace palpate::imaging {
namespace {

// Lowest threshold for bone that is clear of soft tissue: the median of the values of -20 ... 200 HU and
// five of their deviations (median absolute deviation), at least 150 HU above.
double bone_threshold(const Volume& volume) {
    std::vector<float> soft;
    std::ranges::copy_if(volume.values, std::back_inserter(soft),
                         [](float value) { return value >= -20 && value <= 200; });
    const GreyStatistics grey = robust_statistics(soft);
    return grey.mean + std::max(150.0, 5 * grey.sigma);
}

Mask make_bone(const Job& job) {
    const Parameters& p = job.parameters;
    double threshold_hu = p.number("threshold_hu");
    if (threshold_hu == 0) {
        threshold_hu = bone_threshold(*job.volume);
        if (job.note) job.note(fmt::format("{}: threshold {:.0f} HU found", job.culprit(), threshold_hu));
    }
    return bone_of_body(*job.volume, threshold_hu, p.number("separation_mm"));
}

}  // namespace

Recipe bone_recipe() {
    using enum RecipeParameter::Kind;
    return {.name = "bone",
            .meaning = "the bone of the body, without table and head rest",
            .parameters = concatenated(
                {{{"threshold_hu", number, "HU", fmt::format("{}", bone_from_hu),
                   "bone is at least this dense; 0 finds it by itself"},
                  {"separation_mm", number, "mm", "4", "ball that cuts table and head rest off the body",
                   RecipeParameter::Range::not_negative}},
                 region_parameters(),
                 with_defaults(cleaning_parameters(), {{"min_component_ml", "1"}})}),
            .if_empty = "lower threshold_hu or min_component_ml; are the values in HU?",
            .make = make_bone,
            .needs_volume = true,
            .needs_hu = true};
}

}  // namespace palpate::imaging
