// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/detail/detail.hpp"

#include <algorithm>
#include <array>

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
    if (hardware) levels.push_back({.fine_bodies = true, .grain = true, .occlusion = true});
    return levels;
}

bool is_hardware(std::string_view opengl_renderer) {
    constexpr std::array<std::string_view, 4> software{"llvmpipe", "softpipe", "SWR", "Software Rasterizer"};
    return std::ranges::none_of(software, [&](std::string_view name) {
        return opengl_renderer.find(name) != std::string_view::npos;
    });
}

}  // namespace palpate::visual
