// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/detail/detail.hpp"

namespace palpate::visual {

std::vector<Detail> detail_levels(int window_height, bool hardware) {
    constexpr int least_lines = 300;
    std::vector<Detail> levels;
    for (const int pixel : {7, 5, 4, 3})
        if (window_height / pixel >= least_lines) levels.push_back({.pixel = pixel});
    if (window_height / 2 >= least_lines) {
        levels.push_back({.pixel = 2});
        levels.push_back({.pixel = 2, .fine_bodies = true});
    } else {
        levels.push_back({});
    }
    levels.push_back({.fine_bodies = true});
    levels.push_back({.fine_bodies = true, .grain = true});
    if (hardware) {
        levels.push_back({.fine_bodies = true, .grain = true, .occlusion = true});
    } else if (levels.front().pixel > 1) {
        // Blending takes software a sixth of a frame of its least detail.
        levels.insert(levels.begin(), {.pixel = levels.front().pixel, .smooth = false});
    }
    return levels;
}

}  // namespace palpate::visual
