// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/cautions_text.hpp"

#include <algorithm>
#include <sstream>

namespace palpate::visual {
namespace {

// Characters, of UTF-8.
std::size_t length_of(const std::string& text) {
    return static_cast<std::size_t>(std::ranges::count_if(
        text, [](char byte) { return (static_cast<unsigned char>(byte) & 0xC0U) != 0x80U; }));
}

}  // namespace

std::string cautions_text(std::span<const std::string> cautions, std::size_t width) {
    std::string text;
    for (const std::string& caution : cautions) {
        std::istringstream words(caution);
        std::size_t used = 0;
        text += text.empty() ? "" : "\n";
        for (std::string word; words >> word;) {
            const bool fits = used == 0 || used + 1 + length_of(word) <= width;
            text += used == 0 ? "\u2022 " : fits ? " " : "\n   ";
            used = (fits && used > 0 ? used + 1 : 0) + length_of(word);
            text += word;
        }
    }
    return text;
}

}  // namespace palpate::visual
