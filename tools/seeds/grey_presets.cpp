// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/seeds/grey_presets.hpp"

#include <algorithm>

#include "tools/imaging/voxels/hounsfield.hpp"

namespace palpate::seeds {

double GreyPreset::shade(double value) const {
    return std::clamp((value - level) / width + 0.5, 0.0, 1.0);
}

GreyScale grey_scale(const Volume& volume) {
    GreyScale scale;
    scale.offset = imaging::hounsfield_offset(volume);
    scale.hounsfield = scale.offset > 0 || imaging::holds_air(volume);
    if (scale.hounsfield) {
        scale.presets = {{"soft tissue", 400, 40},
                         {"liver", 180, 90},
                         {"brain", 80, 40},
                         {"bone", 1800, 400},
                         {"lung", 1500, -600}};
        for (GreyPreset& preset : scale.presets) preset.level += scale.offset;
        return scale;
    }
    std::vector<float> values = volume.values;
    const auto percentile = [&](double share) {
        const auto at =
            values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
        std::ranges::nth_element(values, at);
        return static_cast<double>(*at);
    };
    const double low = percentile(0.01), width = std::max(percentile(0.99) - low, 1e-6);
    scale.presets = {{"all values", width, low + width / 2},
                     {"dark values", width / 2, low + width / 4},
                     {"bright values", width / 2, low + width * 3 / 4}};
    return scale;
}

}  // namespace palpate::seeds
