// SPDX-License-Identifier: Apache-2.0
#include "formats/model/colour.hpp"

#include <charconv>

namespace palpate {

std::optional<Colour> parse_colour(std::string_view text) {
    if (text.size() != 7 || text[0] != '#') return std::nullopt;
    Colour colour{};
    for (std::size_t channel = 0; channel < colour.size(); ++channel) {
        const char* const digits = text.data() + 1 + 2 * channel;
        if (std::from_chars(digits, digits + 2, colour[channel], 16).ptr != digits + 2) return std::nullopt;
    }
    return colour;
}

std::string colour_text(const Colour& colour) {
    constexpr std::string_view digits = "0123456789abcdef";
    std::string text = "#";
    for (const std::uint8_t channel : colour) {
        text += digits[channel / 16];
        text += digits[channel % 16];
    }
    return text;
}

}  // namespace palpate
