// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/voxels/hounsfield.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace palpate::imaging {
namespace {

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

Mask bone_of_body(const Volume& volume, double threshold_hu, double separation_mm) {
    constexpr double any = std::numeric_limits<double>::infinity(), tissue_above_hu = -300;
    const Mask body = keep_largest(open(threshold(volume, tissue_above_hu, any), separation_mm));
    return intersect(threshold(volume, threshold_hu, any), dilate(body, separation_mm));
}

bool holds_air(const Volume& volume) {
    return std::ranges::any_of(volume.values, [](float value) { return value <= -500; });
}

bool is_ct(const Volume& volume) {
    return holds_air(volume) || hounsfield_offset(volume) > 0;
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

}  // namespace palpate::imaging
