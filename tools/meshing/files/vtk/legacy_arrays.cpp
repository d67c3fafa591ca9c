// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/files/vtk/legacy_arrays.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <fstream>
#include <iterator>
#include <optional>
#include <string>
#include <string_view>

#include "formats/model/errors.hpp"
#include "tools/meshing/files/text.hpp"

namespace palpate::meshing {
namespace {

constexpr std::array<std::string_view, 17> legacy_types{
    "bit",          "char",          "signed_char", "unsigned_char", "short",    "unsigned_short",
    "int",          "unsigned_int",  "long",        "unsigned_long", "float",    "double",
    "vtktypeint64", "vtktypeuint64", "string",      "utf8_string",   "vtkidtype"};

// Negative and larger numbers than any file has bytes count as too many.
std::optional<double> value_of(std::string_view word) {
    double number = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc{} || end == word.data()) return std::nullopt;
    return number;
}

}  // namespace

// Words are looked at wherever they stand, also among the bytes of binary values, where they stand by chance
// once in 2^40.
void require_room_for_arrays(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    const std::string text(std::istreambuf_iterator<char>(stream), {});
    const auto size = static_cast<double>(text.size());
    constexpr double widest = 64;
    const auto require = [&](std::string_view what, double count, double most) {
        if (!(count >= 0 && count <= most))
            throw InvalidInput({path.string(),
                                "announces more " + std::string(what) + " than the file has room for", "",
                                "write the file again"});
    };
    std::array<std::string_view, 4> words;  // the last ones, the latest last
    constexpr std::string_view white = " \t\r\n\v\f";
    for (std::size_t at = text.find_first_not_of(white), end = 0; at != std::string::npos;
         at = text.find_first_not_of(white, end)) {
        end = std::min(text.find_first_of(white, at), text.size());
        std::ranges::rotate(words, words.begin() + 1);
        words[3] = std::string_view(text).substr(at, end - at);
        const auto number = value_of(words[3]);
        if (number && !words[0].empty()) {
            const std::string keyword = lower_case(words[0]), before = lower_case(words[1]);
            if (keyword == "scalars") require("values to a point", *number, widest);
            if (before == "color_scalars" || before == "texture_coordinates")
                require("values to a point", *number, widest);
            if (before == "lookup_table") require("colours", *number, size);
            if (before == "field") require("arrays", *number, size / 8);
        }
        if (!number && words[3].size() < 16 &&
            std::ranges::find(legacy_types, lower_case(words[3])) != legacy_types.end()) {
            const auto components = value_of(words[1]), tuples = value_of(words[2]);
            if (components && tuples) {
                require("values", *components, size);
                require("values", *tuples, size);
                require("values", *components * *tuples, 8 * size);
            }
        }
    }
}

}  // namespace palpate::meshing
