// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <fmt/format.h>
#include <set>

#include "formats/model/errors.hpp"
#include "tools/imaging/recipes/job.hpp"
#include "tools/imaging/voxels/seed_statistics.hpp"

namespace palpate::imaging {
namespace {

constexpr double air_seed_reach = 2;  // mm: a seed may miss narrow air by a voxel or two

// Pieces with a voxel on an edge of the grid's box, where two of its faces meet.
std::set<std::uint32_t> pieces_at_edges(const Components& pieces, const ImageGrid& grid) {
    std::set<std::uint32_t> found;
    const auto& size = grid.size;
    const auto at_end = [&](std::int32_t index, std::size_t axis) {
        return index == 0 || index == size[axis] - 1;
    };
    for (std::int32_t k = 0; k < size[2]; ++k)
        for (std::int32_t j = 0; j < size[1]; ++j)
            for (std::int32_t i = 0; i < size[0]; ++i)
                if (at_end(i, 0) + at_end(j, 1) + at_end(k, 2) >= 2)
                    found.insert(pieces.labels[grid.offset(i, j, k)]);
    found.erase(0);
    return found;
}

Mask outside_air(const Mask& air, double opening_mm) {
    const Mask wide = open(air, opening_mm);
    const Components pieces = components_of(wide);
    const std::set<std::uint32_t> outer = pieces_at_edges(pieces, air.grid);
    const Mask outside = select(wide, pieces, [&](std::uint32_t n) { return outer.contains(n); });
    // Back to where the opening took air away, and one voxel more so that no skin of air stays behind.
    return intersect(air, dilate(outside, opening_mm + air.grid.spacing.maxCoeff()));
}

// Air (below `threshold_hu`) without the outside. The outside is the air that reaches an edge of the volume,
// where two of its faces meet, through openings that a ball of `opening_mm` passes; so a passage cut by the
// last slice stays. Kept are the pieces that hold a seed (p_P, mm) or, without seeds, the largest.
Mask airway(const Volume& volume, std::span<const Eigen::Vector3d> seeds, double threshold_hu,
            double opening_mm, const std::string& culprit) {
    Mask air{volume.grid, std::vector<std::uint8_t>(volume.values.size())};
    std::ranges::transform(volume.values, air.voxels.begin(),
                           [&](float value) { return value < threshold_hu; });
    const Mask inner = subtract(air, outside_air(air, opening_mm));
    if (seeds.empty()) return keep_largest(inner);
    const Components pieces = components_of(inner);
    std::set<std::uint32_t> seeded;
    for (const Eigen::Vector3d& seed : seeds) {
        voxel_of_seed(volume.grid, seed, culprit);
        const auto voxel = nearest_voxel(inner, seed, air_seed_reach);
        if (!voxel)
            throw InvalidInput({culprit, "seed " + point_text(seed) + " is not in the passage",
                                fmt::format("inner air within {} mm", air_seed_reach),
                                "move the seed into the passage, or lower opening_mm if the passage counts "
                                "as outside"});
        seeded.insert(pieces.labels[*voxel]);
    }
    return select(inner, pieces, [&](std::uint32_t n) { return seeded.contains(n); });
}

Mask make_airway(const Job& job) {
    const Parameters& p = job.parameters;
    return airway(*job.volume, seed_points(job), p.number("threshold_hu"), p.number("opening_mm"),
                  job.culprit());
}

}  // namespace

Recipe airway_recipe() {
    using enum RecipeParameter::Kind;
    return {.name = "airway",
            .meaning = "air passages inside the body: those that hold a seed, or else the largest",
            .parameters = concatenated(
                {{{"threshold_hu", number, "HU", "-400", "air is below"},
                  {"opening_mm", number, "mm", "5",
                   "openings to the outside that a ball of this radius does not pass count as closed",
                   RecipeParameter::Range::not_negative}},
                 seed_parameters(),
                 region_parameters(),
                 cleaning_parameters()}),
            .if_empty = "raise threshold_hu, lower opening_mm, or check region and cleaning",
            .make = make_airway,
            .needs_volume = true,
            .needs_hu = true};
}

}  // namespace palpate::imaging
