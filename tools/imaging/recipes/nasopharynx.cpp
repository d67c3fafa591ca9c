// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <set>

#include "tools/imaging/recipes/job.hpp"
#include "tools/imaging/voxels/hounsfield.hpp"

namespace palpate::imaging {
namespace {

// The pieces of a mask that touch `other` by a face.
Mask touching(const Mask& mask, const Mask& other) {
    const auto& grid = mask.grid;
    const auto& size = grid.size;
    const Components pieces = components_of(mask);
    std::set<std::uint32_t> found;
    const auto meets = [&](std::int32_t i, std::int32_t j, std::int32_t k) {
        return grid.contains(i, j, k) && other.voxels[grid.offset(i, j, k)];
    };
    for (std::int32_t k = 0; k < size[2]; ++k)
        for (std::int32_t j = 0; j < size[1]; ++j)
            for (std::int32_t i = 0; i < size[0]; ++i)
                if (const std::uint32_t piece = pieces.labels[grid.offset(i, j, k)];
                    piece && (meets(i - 1, j, k) || meets(i + 1, j, k) || meets(i, j - 1, k) ||
                              meets(i, j + 1, k) || meets(i, j, k - 1) || meets(i, j, k + 1)))
                    found.insert(piece);
    return select(mask, pieces, [&](std::uint32_t n) { return found.contains(n); });
}

// Voxels of lower ... upper HU outside `air` and not in `taken`, within `thickness_mm` of `air` and in
// `region`. Gaps below `smoothing_mm` are closed, spikes below it removed, holes filled, and the largest
// piece that touches `air` by a face is kept.
Mask soft_wall(const Volume& volume, const Mask& air, const Mask& taken, const Region& region,
               double thickness_mm, double lower_hu, double upper_hu, double smoothing_mm) {
    const Mask shell = subtract(subtract(clip(dilate(air, thickness_mm), region), air), taken);
    const Mask soft = intersect(threshold(volume, lower_hu, upper_hu), shell);
    const Mask smooth = open(close(soft, smoothing_mm), smoothing_mm);
    return keep_largest(touching(intersect(fill_holes(smooth), shell), air));
}

Mask make_nasopharynx(const Job& job) {
    const Parameters& p = job.parameters;
    const Mask air = job.structure_named_by("air");
    return soft_wall(*job.volume, air, labelled(job.map), region_of(p), p.number("thickness_mm"),
                     p.number("lower_hu"), p.number("upper_hu"), p.number("smoothing_mm"));
}

}  // namespace

Recipe nasopharynx_recipe() {
    using enum RecipeParameter::Kind;
    using enum RecipeParameter::Range;
    return {
        .name = "nasopharynx",
        .meaning = "the soft wall of an air passage, in one piece",
        .parameters = concatenated(
            {{{"air", structure, "", "airway", "structure the wall encloses"},
              {"thickness_mm", number, "mm", "6", "depth of the wall from the air", not_negative},
              {"lower_hu", number, "HU", "-400", "soft tissue is at least this dense", any},
              {"upper_hu", number, "HU", "225", "soft tissue is at most this dense", any},
              {"smoothing_mm", number, "mm", "1", "gaps and spikes below this radius vanish", not_negative}},
             region_parameters()}),
        .if_empty = "raise thickness_mm or move the region to the passage's wall",
        .make = make_nasopharynx,
        .needs_volume = true,
        .needs_hu = true};
}

}  // namespace palpate::imaging
