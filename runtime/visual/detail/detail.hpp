// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string_view>
#include <vector>

namespace palpate::visual {

/// What of the picture may be left out where a machine is too slow for it.
struct Detail {
    int pixel = 1;  ///< window pixels that one drawn takes along each side
    bool fine_bodies =
        false;               ///< rigid bodies as close to the whole as the budget allows, else a coarser copy
    bool grain = false;      ///< the finest spots of tissue and their relief
    bool occlusion = false;  ///< corners and hollows are darker
};

/// How much of the picture is drawn.
struct ShownDetail {
    int level = 0;             ///< 1: the least; 0: not known yet
    int levels = 0;            ///< of everything
    std::int64_t changes = 0;  ///< of the level so far
};

/// The levels from the least to everything, what is missed least left out first, for a window of so many
/// pixels' height, of which 300 lines are drawn at least. `hardware`: a graphics card draws, not the
/// processor, for which ambient occlusion is too dear.
std::vector<Detail> detail_levels(int window_height, bool hardware);

/// Tells whether that OpenGL renderer is a graphics card, by its name: Mesa's software renderers are
/// llvmpipe, softpipe and SWR.
bool is_hardware(std::string_view opengl_renderer);

}  // namespace palpate::visual
