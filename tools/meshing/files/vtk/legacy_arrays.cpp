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

// VTK looks at how a type's name begins.
bool is_type(std::string_view word) {
    const std::string name = lower_case(word.substr(0, 16));
    return std::ranges::any_of(legacy_types, [&](std::string_view type) { return name.starts_with(type); });
}

// Negative and larger numbers than any file has bytes count as too many.
std::optional<double> value_of(std::string_view word) {
    double number = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc{} || end == word.data()) return std::nullopt;
    return number;
}

}  // namespace

// Words are looked at wherever they stand below version and title, also among the bytes of binary values,
// where they stand by chance once in 2^40.
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
    std::array<std::string_view, 7> words;  // the last ones, the latest last
    const auto is = [&](std::size_t word, std::string_view keyword) {
        return words[word].size() == keyword.size() && lower_case(words[word]) == keyword;
    };
    constexpr std::string_view white = " \t\r\n\v\f";
    const std::size_t title = text.find('\n');
    std::size_t end = title == std::string::npos ? title : text.find('\n', title + 1);
    for (std::size_t at = text.find_first_not_of(white, end); at != std::string::npos;
         at = text.find_first_not_of(white, end)) {
        end = std::min(text.find_first_of(white, at), text.size());
        std::ranges::rotate(words, words.begin() + 1);
        words[6] = std::string_view(text).substr(at, end - at);
        if (const auto number = value_of(words[6])) {
            if (is(3, "scalars") && is_type(words[5])) require("values to a point", *number, widest);
            if (is(4, "color_scalars") || is(4, "texture_coordinates"))
                require("values to a point", *number, widest);
            // SCALARS name type [components] LOOKUP_TABLE name: their first value follows, no number of
            // colours.
            const bool of_scalars =
                (is(1, "scalars") && is_type(words[3])) || (is(0, "scalars") && is_type(words[2]));
            if (is(4, "lookup_table") && !of_scalars) require("colours", *number, size);
            if (is(4, "field")) require("arrays", std::max(*number, 0.0), size / 8);
        } else if (is_type(words[6])) {
            const auto components = value_of(words[4]), tuples = value_of(words[5]);
            if (components && tuples) {
                require("values", *components, size);
                require("values", *tuples, size);
                require("values", *components * *tuples, 8 * size);
            }
        }
    }
}

}  // namespace palpate::meshing
