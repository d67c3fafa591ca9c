// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/recipes/job.hpp"
#include "tools/imaging/voxels/hounsfield.hpp"

namespace palpate::imaging {
namespace {

Mask make_threshold(const Job& job) {
    const Parameters& p = job.parameters;
    return threshold(*job.volume, p.number("lower_hu"), p.number("upper_hu"));
}

}  // namespace

Recipe threshold_recipe() {
    using enum RecipeParameter::Kind;
    using enum RecipeParameter::Range;
    return {.name = "threshold",
            .meaning = "the voxels of a range of values",
            .parameters = concatenated({{{"lower_hu", number, "HU", "-inf", "lowest value", any},
                                         {"upper_hu", number, "HU", "inf", "highest value", any}},
                                        region_parameters(),
                                        cleaning_parameters()}),
            .if_empty = "widen lower_hu ... upper_hu, or check region and cleaning",
            .make = make_threshold,
            .needs_volume = true};
}

}  // namespace palpate::imaging
