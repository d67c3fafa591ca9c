// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cctype>
#include <fmt/format.h>
#include <regex>

#include "tools/archive/privacy/searches.hpp"

namespace palpate::archive {
namespace {

struct Pattern {
    std::string kind;
    std::regex expression;  ///< its first group is the value
    std::string sign;       ///< a text without it, in any case, does not match; empty: always tried
};

// Each is tried on pieces of bounded length: std::regex recurses with the length of what it matches.
const std::vector<Pattern>& patterns() {
    constexpr auto flags = std::regex::ECMAScript | std::regex::icase | std::regex::optimize;
    static const std::vector<Pattern> all{
        {"e-mail address",
         std::regex(R"(([a-z0-9][a-z0-9._%+-]{0,63}@[a-z0-9-]{1,63}(\.[a-z0-9-]{1,63}){0,4}\.[a-z]{2,10}))",
                    flags),
         "@"},
        {"date of birth",
         std::regex(
             R"((?:birth|born|\bdob\b|geboren|naissance).{0,24}?([0-9]{1,4}[-./ ][0-9]{1,2}[-./ ][0-9]{1,4}|[12][0-9]{7}))",
             flags),
         ""},
        {"person's name", std::regex(R"(((?:^|[^a-z])[a-z][a-z'-]+\^[a-z][a-z'-]+))", flags), "^"},
        {"patient field",
         std::regex(
             R"((?:\b|_)(?:patient|subject)[ '_-]?s?[ _-]?(?:name|id|identifier|sex|age|weight|birth[ _-]?date|address)\b["']?\s*(?::=|[:=])\s*["']?([^\s"',;}]{2,}))",
             flags),
         ":="},
        {"study field",
         std::regex(
             R"((?:\b|_)(?:accession[ _-]?number|institution(?:[ _-]?name)?|(?:referring|performing)[ _-]?physician(?:s?[ _-]?name)?|study[ _-]?date|series[ _-]?date|acquisition[ _-]?date|medical[ _-]?record[ _-]?number|mrn)\b["']?\s*(?::=|[:=])\s*["']?([^\s"',;}]{2,}))",
             flags),
         ":="},
        {"UID", std::regex(R"((?:^|[^0-9.])([012](?:\.(?:0|[1-9][0-9]{0,38})){5,30})(?![0-9.]))", flags), ""},
        {"path", std::regex(R"(((?:^|[^a-z0-9])[a-z]:\\\\?[a-z0-9_ .-]+\\\\?[a-z0-9_ .-]+))", flags), "\\"},
    };
    return all;
}

bool part_of_word(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

// Where a word begins at or after `from`; npos if nowhere.
std::size_t find_word(std::string_view text, std::string_view word, std::size_t from) {
    for (std::size_t at = text.find(word, from); at != std::string_view::npos; at = text.find(word, at + 1)) {
        const std::size_t end = at + word.size();
        if ((at == 0 || !part_of_word(text[at - 1])) && (end == text.size() || !part_of_word(text[end])))
            return at;
    }
    return std::string_view::npos;
}

bool path_character(char c) {
    return part_of_word(c) || c == '.' || c == '-' || c == '+' || c == '~' || c == '@' || c == '/';
}

// Absolute paths: "/home/..." with a name behind, no part of another path or of an address.
template <typename Found>
void find_paths(std::string_view text, const Machine& machine, const Found& found) {
    for (std::size_t at = text.find('/'); at != std::string_view::npos; at = text.find('/', at + 1)) {
        if (at > 0 && (path_character(text[at - 1]) || text[at - 1] == '<' || text[at - 1] == '}')) {
            const bool file_scheme = text.substr(0, at).ends_with("file://");
            if (!file_scheme) continue;
        }
        const std::size_t end = std::min(text.find('/', at + 1), text.size());
        if (end + 1 >= text.size() || !part_of_word(text[end + 1])) continue;
        if (std::ranges::find(machine.folders, text.substr(at + 1, end - at - 1)) == machine.folders.end())
            continue;
        std::size_t stop = at;
        while (stop < text.size() && path_character(text[stop])) ++stop;
        found(text.substr(at, stop - at));
        at = stop - 1;
    }
}

template <typename Found>
void find_names(std::string_view text, const Machine& machine, const Found& found) {
    for (const std::string& user : machine.users)
        if (find_word(text, user, 0) != std::string_view::npos) found("user name", user);
    for (const std::string& host : machine.hosts)
        if (find_word(text, host, 0) != std::string_view::npos) found("host name", host);
}

void search_piece(std::string_view piece, const std::filesystem::path& file, const std::string& where,
                  const Machine& machine, Findings& findings) {
    const auto found = [&](const std::string& kind, std::string_view value) {
        findings.push_back({file, where, kind, shortened(std::string(value))});
    };
    find_names(piece, machine, found);
    find_paths(piece, machine, [&](std::string_view path) { found("path", path); });
    for (const Pattern& pattern : patterns()) {
        if (!pattern.sign.empty() && piece.find_first_of(pattern.sign) == std::string_view::npos) continue;
        std::match_results<std::string_view::const_iterator> match;
        if (!std::regex_search(piece.begin(), piece.end(), match, pattern.expression)) continue;
        const std::string value = match[1].str();
        if (pattern.kind == "UID" && (value.size() < 20 || value.starts_with("1.2.840.10008."))) continue;
        found(pattern.kind, value);
    }
}

}  // namespace

std::string shortened(const std::string& value) {
    std::string start;
    for (const char c : value.substr(0, 2))
        start += c >= ' ' && static_cast<unsigned char>(c) < 0x7F ? c : '?';
    return fmt::format("{}... ({} characters)", start, value.size());
}

void search_text(std::string_view text, const std::filesystem::path& file, const std::string& where,
                 bool lines, const Machine& machine, Findings& findings) {
    constexpr std::size_t longest = 2000,
                          overlap = 200;  // of a piece; what lies across two is in one of them
    std::size_t line = 0;
    while (!text.empty()) {
        ++line;
        const std::size_t end = std::min(text.find('\n'), text.size());
        const std::string place = lines ? fmt::format("{}line {}", where, line) : where;
        const std::size_t before = findings.size();
        for (std::size_t at = 0; at < end; at += longest - overlap) {
            search_piece(text.substr(at, std::min(longest, end - at)), file, place, machine, findings);
            if (at + longest >= end) break;
        }
        // Twice in an overlap, or often on a line, is one finding.
        const auto same = [](const Finding& a, const Finding& b) {
            return a.kind == b.kind && a.value == b.value;
        };
        const auto first = findings.begin() + static_cast<std::ptrdiff_t>(before);
        for (auto one = first; one != findings.end(); ++one)
            findings.erase(
                std::remove_if(one + 1, findings.end(), [&](const Finding& f) { return same(*one, f); }),
                findings.end());
        text.remove_prefix(std::min(end + 1, text.size()));
    }
}

void search_bytes(std::string_view bytes, const std::filesystem::path& file, const Machine& machine,
                  Findings& findings) {
    constexpr std::size_t shortest = 8;
    for (std::size_t at = 0; at < bytes.size();) {
        std::size_t end = at;
        while (end < bytes.size() && bytes[end] >= ' ' && static_cast<unsigned char>(bytes[end]) < 0x7F)
            ++end;
        if (end - at >= shortest) {
            const std::string_view run = bytes.substr(at, end - at);
            const auto found = [&](const std::string& kind, std::string_view value) {
                findings.push_back({file, fmt::format("byte {}", at), kind, shortened(std::string(value))});
            };
            find_names(run, machine, [&](const std::string& kind, const std::string& name) {
                if (name.size() >= 5) found(kind, name);
            });
            find_paths(run, machine, [&](std::string_view path) {
                if (path.size() >= shortest) found("path", path);
            });
        }
        at = end + 1;
    }
}

}  // namespace palpate::archive
