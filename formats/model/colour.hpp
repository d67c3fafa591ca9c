// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace palpate {

/// Red, green and blue of sRGB, 0 ... 255.
using Colour = std::array<std::uint8_t, 3>;

/// Reads "#7a3a2f", digits in either case; none if the text is of another form.
std::optional<Colour> parse_colour(std::string_view text);

/// Writes it so, in lower case.
std::string colour_text(const Colour& colour);

/// The colour in which one region of a tetrahedral mesh is drawn.
struct RegionColour {
    std::int32_t region = 0;  ///< label value as in TetMesh::regions
    Colour colour{};
};

}  // namespace palpate
