// SPDX-License-Identifier: Apache-2.0
#include "formats/toml_file/parse_file.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>

#include "formats/model/errors.hpp"
#include "formats/model/reading/small_file.hpp"

namespace palpate::toml_file {
namespace {

// What no file that a person writes comes near. A full stop in a key nests a table in a table, which
// toml++ 3.3 does not limit, though it takes tables down by recursion.
constexpr std::uintmax_t most_bytes = 1 << 20;
constexpr std::size_t most_full_stops = 4096;

// Behind the text in quotation marks that begins at `at`, or where a line ends within it.
std::size_t end_of_quoted(std::string_view text, std::size_t at) {
    const char mark = text[at];
    const std::string three(3, mark);
    const bool lines = text.substr(at, 3) == three;
    for (at += lines ? 3 : 1; at < text.size(); ++at) {
        if (mark == '"' && text[at] == '\\') {
            ++at;
        } else if (!lines && (text[at] == mark || text[at] == '\n')) {
            return at + 1;
        } else if (lines && text.substr(at, 3) == three) {
            at += 3;  // of up to five marks the last three end it
            for (int more = 0; more < 2 && at < text.size() && text[at] == mark; ++more) ++at;
            return at;
        }
    }
    return text.size();
}

// Full stops outside quotation marks, comments and numbers: "1.5" is a number unless a key goes on behind it.
std::size_t full_stops_in_keys(std::string_view text) {
    constexpr std::string_view digits = "0123456789";
    std::size_t stops = 0;
    for (std::size_t at = 0; at < text.size();) {
        if (text[at] == '#') {
            at = std::min(text.find('\n', at), text.size());
        } else if (text[at] == '"' || text[at] == '\'') {
            at = end_of_quoted(text, at);
        } else if (const std::size_t end = std::min(text.find_first_of(" \t\r\n#\"'=,[]{}", at), text.size());
                   end > at) {
            const std::string_view word = text.substr(at, end - at);
            const auto found = static_cast<std::size_t>(std::ranges::count(word, '.'));
            const std::size_t stop = word.find('.');
            const std::size_t next = text.find_first_not_of(" \t", end);
            const bool goes_on = next != std::string_view::npos && (text[next] == '.' || text[next] == '=');
            const bool number =
                found == 1 &&
                digits.find(word[word[0] == '-' || word[0] == '+' ? 1 : 0]) != std::string_view::npos &&
                stop + 1 < word.size() && digits.find(word[stop + 1]) != std::string_view::npos;
            if (!number || goes_on) stops += found;
            at = end;
        } else {
            ++at;
        }
    }
    return stops;
}

}  // namespace

toml::table parse_text(const std::string& text, const std::filesystem::path& path,
                       const std::string& next_step) {
    if (const std::size_t stops = full_stops_in_keys(text); stops > most_full_stops)
        throw InvalidInput({path.string(), fmt::format("has {} full stops in keys", stops),
                            fmt::format("{} at most, for each nests a table", most_full_stops), next_step});
    try {
        return toml::parse(text, path.string());
    } catch (const toml::parse_error& error) {
        const auto line = error.source().begin.line;
        throw InvalidInput({line > 0 ? fmt::format("{}:{}", path.string(), line) : path.string(),
                            std::string(error.description()), "", next_step});
    }
}

toml::table parse_file(const std::filesystem::path& path, const std::string& next_step) {
    require_small_file(path, most_bytes);
    std::ifstream stream(path, std::ios::binary);
    if (!stream) throw InvalidInput({path.string(), "cannot be read", "", "check the path"});
    return parse_text(std::string(std::istreambuf_iterator<char>(stream), {}), path, next_step);
}

}  // namespace palpate::toml_file
