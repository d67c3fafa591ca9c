// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/recipes/recipes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <set>

#include "formats/model/errors.hpp"
#include "tools/imaging/voxels/seed_statistics.hpp"

namespace palpate {
namespace {

constexpr double tissue_above_hu = -300;
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

// The value from 1 to 200 about which most values lie within 10; 0 if they are less than a hundredth of all.
// Zeros are left out: padding, or what was cut off below.
std::size_t commonest_low_value(const Volume& volume) {
    constexpr std::size_t reach = 10, last = 200;
    std::array<std::size_t, last + reach + 1> counts{};
    for (const float value : volume.values)
        if (const auto rounded = std::round(value);
            rounded >= 1 && rounded < static_cast<float>(counts.size()))
            ++counts[static_cast<std::size_t>(rounded)];
    std::size_t commonest = 0, most = 0;
    for (std::size_t value = 1; value <= last; ++value) {
        std::size_t near = 0;
        for (std::size_t i = value - std::min(value, reach); i <= value + reach; ++i) near += counts[i];
        if (near > most) {
            most = near;
            commonest = value;
        }
    }
    return most * 100 < volume.values.size() ? 0 : commonest;
}

}  // namespace

Mask threshold(const Volume& volume, double lower_hu, double upper_hu) {
    Mask mask{volume.grid, std::vector<std::uint8_t>(volume.values.size())};
    std::ranges::transform(volume.values, mask.voxels.begin(),
                           [&](float value) { return value >= lower_hu && value <= upper_hu; });
    return mask;
}

double hounsfield_offset(const Volume& volume) {
    const std::size_t air = commonest_low_value(volume);
    const double offset = air > 0 && air < 14 ? 1000 : 1024;
    std::size_t soft_tissue = 0, between = 0;  // between air and soft tissue lies little but lung
    for (const float value : volume.values) {
        if (value < 0) return 0;
        soft_tissue += value > offset - 150 && value < offset + 150;
        between += value > 200 && value < 800;
    }
    return soft_tissue * 20 > volume.values.size() && soft_tissue > 3 * between ? offset : 0;
}

double bone_threshold(const Volume& volume) {
    std::vector<float> soft;
    std::ranges::copy_if(volume.values, std::back_inserter(soft),
                         [](float value) { return value >= -20 && value <= 200; });
    const GreyStatistics grey = robust_statistics(soft);
    return grey.mean + std::max(150.0, 5 * grey.sigma);
}

Mask bone(const Volume& volume, double threshold_hu, double separation_mm) {
    constexpr double any = std::numeric_limits<double>::infinity();
    const Mask body = keep_largest(open(threshold(volume, tissue_above_hu, any), separation_mm));
    return intersect(threshold(volume, threshold_hu, any), dilate(body, separation_mm));
}

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

Mask soft_wall(const Volume& volume, const Mask& air, const Mask& taken, const Region& region,
               double thickness_mm, double lower_hu, double upper_hu, double smoothing_mm) {
    const Mask shell = subtract(subtract(clip(dilate(air, thickness_mm), region), air), taken);
    const Mask soft = intersect(threshold(volume, lower_hu, upper_hu), shell);
    const Mask smooth = open(close(soft, smoothing_mm), smoothing_mm);
    return keep_largest(touching(intersect(fill_holes(smooth), shell), air));
}

}  // namespace palpate
