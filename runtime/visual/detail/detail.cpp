// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/detail/detail.hpp"

#include <algorithm>
#include <array>

namespace palpate::visual {

std::span<const Detail> detail_levels(bool hardware) {
    static constexpr std::array levels{
        Detail{.pixel = 4},
        Detail{.pixel = 3},
        Detail{.pixel = 2},
        Detail{.pixel = 2, .fine_bodies = true},
        Detail{.fine_bodies = true},
        Detail{.fine_bodies = true, .grain = true},
        Detail{.fine_bodies = true, .grain = true, .occlusion = true},
    };
    return std::span(levels).first(levels.size() - (hardware ? 0 : 1));
}

bool is_hardware(std::string_view opengl_renderer) {
    constexpr std::array<std::string_view, 4> software{"llvmpipe", "softpipe", "SWR", "Software Rasterizer"};
    return std::ranges::none_of(software, [&](std::string_view name) {
        return opengl_renderer.find(name) != std::string_view::npos;
    });
}

}  // namespace palpate::visual
