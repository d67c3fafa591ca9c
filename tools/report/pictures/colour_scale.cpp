// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/report/pictures/colour_scale.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <fmt/format.h>
#include <vector>

namespace palpate::report {
namespace {

constexpr std::array<std::array<int, 3>, 9> stops{{{255, 255, 204},
                                                   {255, 237, 160},
                                                   {254, 217, 118},
                                                   {254, 178, 76},
                                                   {253, 141, 60},
                                                   {252, 78, 42},
                                                   {227, 26, 28},
                                                   {189, 0, 38},
                                                   {128, 0, 38}}};

}  // namespace

std::array<std::uint8_t, 3> ColourScale::colour_of(double value) const {
    const double place = std::clamp(value / top, 0.0, 1.0) * (stops.size() - 1);
    const auto below = std::min(static_cast<std::size_t>(place), stops.size() - 2);
    const double part = place - static_cast<double>(below);
    std::array<std::uint8_t, 3> colour{};
    for (std::size_t c = 0; c < 3; ++c)
        colour[c] =
            static_cast<std::uint8_t>(std::lround((1 - part) * stops[below][c] + part * stops[below + 1][c]));
    return colour;
}

ColourScale scale_for(std::span<const double> values) {
    assert(!values.empty());
    std::vector<double> ranked(values.begin(), values.end());
    const auto most =
        ranked.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(ranked.size() - 1));
    std::ranges::nth_element(ranked, most);
    const double least = std::max(*most, 0.001), decade = std::pow(10, std::floor(std::log10(least)));
    for (const double step : {1.0, 2.0, 5.0})
        if (step * decade >= least) return {step * decade};
    return {10 * decade};
}

std::string scale_svg(const ColourScale& scale, const std::string& unit) {
    constexpr int left = 20, width = 360, height = 16, ticks = 4;
    std::string svg =
        "<svg class=\"scale-bar\" viewBox=\"0 0 420 46\" role=\"img\" aria-label=\"colour scale\">";
    constexpr int strips = 72;
    for (int strip = 0; strip < strips; ++strip) {
        const auto c = scale.colour_of(scale.top * (strip + 0.5) / strips);
        svg += fmt::format("<rect x=\"{}\" y=\"2\" width=\"{}\" height=\"{}\" fill=\"rgb({},{},{})\"/>",
                           left + width / strips * strip, width / strips + 1, height, c[0], c[1], c[2]);
    }
    for (int tick = 0; tick <= ticks; ++tick) {
        const int x = left + width * tick / ticks;
        svg += fmt::format(
            "<path class=\"axis\" d=\"M{0} 18v5\"/><text class=\"tick\" x=\"{0}\" y=\"38\" "
            "text-anchor=\"middle\">{1}{2:g}{3}</text>",
            x, tick == ticks ? "≥ " : "", scale.top * tick / ticks, tick == ticks ? " " + unit : "");
    }
    return svg + "</svg>";
}

}  // namespace palpate::report
