// SPDX-License-Identifier: Apache-2.0
#include "formats/toml_file/parse_file.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <iterator>

#include "formats/model/errors.hpp"
#include "formats/model/small_file.hpp"

namespace palpate::toml_file {
namespace {

// What no file that a person writes comes near. A full stop may nest a table in a table, which toml++ 3.3
// does not limit, though it takes tables down by recursion.
constexpr std::uintmax_t most_bytes = 1 << 20;
constexpr std::ptrdiff_t most_full_stops = 4096;

std::string text_of(const std::filesystem::path& path, const std::string& next_step) {
    require_small_file(path, most_bytes);
    std::ifstream stream(path, std::ios::binary);
    if (!stream) throw InvalidInput({path.string(), "cannot be read", "", "check the path"});
    const std::string text(std::istreambuf_iterator<char>(stream), {});
    if (const auto stops = std::ranges::count(text, '.'); stops > most_full_stops)
        throw InvalidInput({path.string(), fmt::format("has {} full stops", stops),
                            fmt::format("{} at most, for each may nest a table", most_full_stops),
                            next_step});
    return text;
}

}  // namespace

toml::table parse_file(const std::filesystem::path& path, const std::string& next_step) {
    try {
        return toml::parse(text_of(path, next_step), path.string());
    } catch (const toml::parse_error& error) {
        const auto line = error.source().begin.line;
        throw InvalidInput({line > 0 ? fmt::format("{}:{}", path.string(), line) : path.string(),
                            std::string(error.description()), "", next_step});
    }
}

}  // namespace palpate::toml_file
