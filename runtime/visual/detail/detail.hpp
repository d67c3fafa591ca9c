// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

namespace palpate::visual {

/// What of the picture may be left out where a machine is too slow for it.
struct Detail {
    int pixel = 1;       ///< window pixels that one drawn takes along each side
    bool smooth = true;  ///< pixels of the window between those drawn are blended, else as the nearest one
    bool fine_bodies =
        false;               ///< rigid bodies as close to the whole as the budget allows, else a coarser copy
    bool grain = false;      ///< the finest spots of tissue and their relief
    bool occlusion = false;  ///< creases, and what lies close to something else, get less light
};

/// How much of the picture is drawn.
struct ShownDetail {
    int level = 0;             ///< 1: the least; 0: not known yet
    int levels = 0;            ///< of everything
    std::int64_t changes = 0;  ///< of the level so far
};

/// The levels from the least to everything, what is missed least left out first, for a window of so many
/// pixels' height, of which 300 lines are drawn at least. `hardware`: a graphics card draws; without one
/// occlusion is too slow, and pixels are not blended in the least.
std::vector<Detail> detail_levels(int window_height, bool hardware);

}  // namespace palpate::visual
