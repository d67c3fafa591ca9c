// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/recipes/job.hpp"

namespace palpate::imaging {
namespace {

Mask make_sphere(const Job& job) {
    const Parameters& p = job.parameters;
    const Mask inside = job.structure_named_by("inside");
    return clip(inside, {{{p.point("center_mm"), p.number("radius_mm")}}, {}});
}

}  // namespace

Recipe sphere_recipe() {
    using enum RecipeParameter::Kind;
    return {.name = "sphere",
            .meaning = "a ball within another structure",
            .parameters = {{"inside", structure, "", "", "structure whose voxels it takes"},
                           {"center_mm", point, "mm", "", "centre x, y, z"},
                           {"radius_mm", number, "mm", "", "radius", RecipeParameter::Range::not_negative}},
            .if_empty = "move center_mm into the structure named by 'inside', or raise radius_mm",
            .make = make_sphere,
            .makes_up = true};
}

}  // namespace palpate::imaging
