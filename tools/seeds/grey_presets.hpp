// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "formats/model/image_grid.hpp"

namespace palpate::seeds {

/// Which values are drawn between black and white: level - width / 2 ... level + width / 2.
struct GreyPreset {
    std::string name;
    double width = 400;
    double level = 40;

    /// 0 (black) ... 1 (white).
    double shade(double value) const;
};

/// What the window offers for a volume, the first shown first.
struct GreyScale {
    std::vector<GreyPreset> presets;
    bool hounsfield = false;  ///< a CT
    double offset = 0;        ///< how far stored values lie above HU; presets are in stored values
};

/// The usual windows of a CT (soft tissue, liver, brain, bone, lung); for anything else the 1st ... 99th
/// percentile of values and its darker and brighter half. A volume counts as CT if it holds values of -500 HU
/// or less, as air has, or of a CT stored as value + 1024. Linear in voxels.
GreyScale grey_scale(const Volume& volume);

}  // namespace palpate::seeds
