// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string>

namespace palpate::report {

/// Colours for 0 ... top, pale yellow to dark red, which colour-blind eyes tell apart too; greater values
/// have the colour of `top`. Source: YlOrRd of ColorBrewer (Harrower, Brewer 2003).
struct ColourScale {
    double top = 1;  ///< in the unit of the values

    std::array<std::uint8_t, 3> colour_of(double value) const;
};

/// A scale that ends at a round number (1, 2 or 5 times a power of ten), the least that 95 % of the values
/// stay below. Precondition: there are values (asserted).
ColourScale scale_for(std::span<const double> values);

/// Draws the scale as a bar with its numbers, inline SVG.
std::string scale_svg(const ColourScale& scale, const std::string& unit);

}  // namespace palpate::report
