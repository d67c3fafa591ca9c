// SPDX-License-Identifier: Apache-2.0
#include "formats/model/reading/utf8.hpp"

#include <array>
#include <bit>
#include <cstddef>
#include <optional>

namespace palpate {
namespace {

// The character that a text begins with, which is made shorter by it; none if there is no such.
std::optional<char32_t> take_character(std::string_view& text) {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
    const auto leading_ones = static_cast<std::size_t>(std::countl_one(byte(0)));
    const std::size_t length = leading_ones == 0 ? 1 : leading_ones;
    if (leading_ones == 1 || length > 4 || length > text.size()) return std::nullopt;
    char32_t character = byte(0) & (0xFFU >> (leading_ones + 1));
    for (std::size_t i = 1; i < length; ++i) {
        if (byte(i) >> 6 != 2) return std::nullopt;
        character = (character << 6) | (byte(i) & 0x3FU);
    }
    constexpr std::array<char32_t, 5> least{0, 0, 0x80, 0x800, 0x10000};
    const bool surrogate = character >= 0xD800 && character <= 0xDFFF;
    if (character < least[length] || character > 0x10FFFF || surrogate) return std::nullopt;
    text.remove_prefix(length);
    return character;
}

bool is_shown(char32_t c) {
    const bool control = c < 0x20 || (c >= 0x7F && c <= 0x9F);
    // Those of Unicode's categories Cf, Zl and Zp that have no picture or turn the direction of writing. Not
    // the joiners U+200C and U+200D, by which words of Persian and Indic scripts are written.
    const bool unseen = c == 0xAD || c == 0x61C || c == 0x180E || c == 0x200B || c == 0x200E || c == 0x200F ||
                        (c >= 0x2028 && c <= 0x202E) || (c >= 0x2060 && c <= 0x206F) || c == 0xFEFF ||
                        (c >= 0xFFF9 && c <= 0xFFFB) || (c >= 0xE0000 && c <= 0xE007F);
    return !control && !unseen;
}

}  // namespace

bool is_utf8(std::string_view text) {
    while (!text.empty())
        if (!take_character(text)) return false;
    return true;
}

bool is_printable(std::string_view text) {
    while (!text.empty())
        if (const auto character = take_character(text); !character || !is_shown(*character)) return false;
    return true;
}

}  // namespace palpate
