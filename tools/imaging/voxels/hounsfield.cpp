// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/voxels/hounsfield.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <vector>

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

// How many values lie in each of equal ranges from the lowest on. Of whole numbers each range has as many.
struct Histogram {
    double lowest, width;
    std::vector<double> counts;

    explicit Histogram(const Volume& volume) {
        constexpr double ranges = 256;
        const auto [low, high] = std::ranges::minmax(volume.values);
        const bool whole =
            std::ranges::all_of(volume.values, [](float value) { return value == std::round(value); });
        lowest = low;
        width = std::max<double>(high - low, 1e-6) / ranges;
        if (whole) width = std::max(1.0, std::ceil(width));
        counts.resize(static_cast<std::size_t>((high - low) / width) + 1);
        for (const float value : volume.values) ++counts[static_cast<std::size_t>((value - low) / width)];
        if (whole) lowest -= 0.5;  // a range's numbers lie evenly about its middle
    }

    // Of the fullest from one range on, and before another, three side by side counting: the mean value.
    double commonest(std::size_t from, std::size_t end) const {
        double most = 0, value = lowest;
        for (std::size_t middle = from; middle < end; ++middle) {
            double count = 0, sum = 0;
            for (std::size_t i = middle - std::min<std::size_t>(middle, 1);
                 i < std::min(middle + 2, counts.size()); ++i) {
                count += counts[i];
                sum += counts[i] * (static_cast<double>(i) + 0.5);
            }
            if (count <= most) continue;
            most = count;
            value = lowest + width * sum / count;
        }
        return value;
    }
};

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

void rescale(Volume& volume, const HounsfieldScale& to_hounsfield) {
    for (float& value : volume.values)
        value = static_cast<float>(to_hounsfield.scale * value + to_hounsfield.offset);
}

std::optional<HounsfieldScale> scale_by_air_and_soft_tissue(const Volume& volume) {
    constexpr double air_hu = -1000, soft_hu = 40;
    // Soft tissue and fat: of the tests' head CT they are 0.75 of the body, of its window from -500 HU on,
    // whose scale comes out wrong, 0.70, of an MRI 0.4. Air, and the body: of all.
    constexpr double least_of_body = 0.72, least_of_all = 0.1;
    constexpr double darkest_bone = 600, brightest_metal = 4500;  // HU
    if (std::ranges::any_of(volume.values, [](float value) { return value < 0; })) return std::nullopt;
    const Histogram histogram(volume);
    const std::size_t ranges = histogram.counts.size(), quarter = std::max<std::size_t>(2, ranges / 4);
    const double air = histogram.commonest(0, std::min(quarter, ranges));
    const auto above = static_cast<std::size_t>((air - histogram.lowest) / histogram.width) +
                       std::max<std::size_t>(3, ranges / 20);
    if (above >= ranges) return std::nullopt;
    const double soft = histogram.commonest(above, ranges);
    const double scale = (soft_hu - air_hu) / (soft - air);
    const HounsfieldScale found{scale, air_hu - scale * air};
    std::size_t in_air = 0, in_body = 0, in_soft = 0;
    double brightest = air_hu;
    for (const float value : volume.values) {
        const double hu = found.scale * value + found.offset;
        in_air += std::abs(hu - air_hu) < 60;
        in_body += hu > (air_hu + soft_hu) / 2;
        in_soft += hu > soft_hu - 200 && hu < soft_hu + 125;
        brightest = std::max(brightest, hu);
    }
    const auto share = [](std::size_t part, std::size_t whole) {
        return static_cast<double>(part) / static_cast<double>(std::max<std::size_t>(whole, 1));
    };
    const bool is_ct = share(in_air, volume.values.size()) > least_of_all &&
                       share(in_body, volume.values.size()) > least_of_all &&
                       share(in_soft, in_body) > least_of_body && brightest > darkest_bone &&
                       brightest < brightest_metal;
    return is_ct ? std::optional(found) : std::nullopt;
}

std::string text_of(const HounsfieldScale& to_hounsfield) {
    return fmt::format("HU = {:.4g} x value {} {:.4g}", to_hounsfield.scale,
                       to_hounsfield.offset < 0 ? '-' : '+', std::abs(to_hounsfield.offset));
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
