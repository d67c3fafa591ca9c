// SPDX-License-Identifier: Apache-2.0
#include "runtime/doctor/report.hpp"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sstream>

namespace palpate::doctor {
namespace {

bool in_word(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
}

// Where `word` begins and ends at the edge of a word.
void replace_word(std::string& text, const std::string& word, const std::string& by) {
    if (word.empty()) return;
    for (std::size_t at = text.find(word); at != std::string::npos;) {
        const std::size_t end = at + word.size();
        const bool alone = (at == 0 || !in_word(text[at - 1]) || !in_word(word.front())) &&
                           (end == text.size() || !in_word(text[end]));
        if (alone) text.replace(at, word.size(), by);
        at = text.find(word, at + (alone ? by.size() : 1));
    }
}

// "/home/NAME" of somebody else.
void hide_homes(std::string& text) {
    const std::string homes = "/home/";
    for (std::size_t at = text.find(homes); at != std::string::npos; at = text.find(homes, at + 1)) {
        std::size_t end = at + homes.size();
        while (end < text.size() && (in_word(text[end]) || text[end] == '.')) ++end;
        text.replace(at, end - at, "~");
    }
}

}  // namespace

std::string anonymous(std::string text, const Machine& machine) {
    replace_word(text, machine.home == "/" ? "" : machine.home.string(), "~");
    hide_homes(text);
    if (machine.user != "root") replace_word(text, machine.user, "$USER");
    if (machine.host != "localhost") replace_word(text, machine.host, "$HOSTNAME");
    return text;
}

std::string report_text(const Findings& findings) {
    std::string text;
    std::size_t width = 0;
    for (const Finding& finding : findings) width = std::max(width, finding.id.size());
    for (std::size_t i = 0; i < findings.size(); ++i) {
        const Finding& finding = findings[i];
        if (i == 0 || finding.group != findings[i - 1].group) text += finding.group + "\n";
        text +=
            fmt::format("  {:<7}  {:<{}}  {}\n", name_of(finding.level), finding.id, width, finding.found);
        std::istringstream lines(finding.fix);
        for (std::string line; std::getline(lines, line);) text += "      " + line + "\n";
    }
    return text;
}

nlohmann::ordered_json report_json(const Findings& findings, const Machine& machine) {
    auto rows = nlohmann::ordered_json::array();
    for (const Finding& finding : findings)
        rows.push_back({{"id", anonymous(finding.id, machine)},
                        {"group", finding.group},
                        {"level", name_of(finding.level)},
                        {"found", anonymous(finding.found, machine)},
                        {"fix", anonymous(finding.fix, machine)}});
    return rows;
}

}  // namespace palpate::doctor
