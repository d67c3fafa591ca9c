// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/commands/init/request.hpp"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>
#include <string_view>

#include "formats/model/errors.hpp"
#include "formats/toml_file/quoted.hpp"
#include "tools/draft/anatomy.hpp"

namespace palpate::commands {
namespace {

std::string quoted_for_a_shell(const std::string& word) {
    const bool plain = !word.empty() && std::ranges::all_of(word, [](unsigned char c) {
        return std::isalnum(c) != 0 ||
               std::string_view("_./,:=-+").find(static_cast<char>(c)) != std::string_view::npos;
    });
    if (plain) return word;
    std::string quoted = "'";
    for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
    return quoted + "'";
}

}  // namespace

draft::Wishes wishes_of(const InitRequest& request) {
    draft::Wishes wishes{.organ = request.organ};
    if (!request.approach.empty()) wishes.approach = draft::direction_of(request.approach, "--approach");
    if (request.contact_nodes > 0) wishes.contact_nodes = request.contact_nodes;
    if (request.size_mib > 0) wishes.contact_nodes = draft::nodes_within(request.size_mib);
    return wishes;
}

void check_name(const std::string& organ) {
    if (organ.find_first_of(":\n\r\t") != std::string::npos)
        throw UsageError({"--organ", toml_file::quoted(organ), "a name without colons and line breaks", ""});
}

std::string command_of(const InitRequest& request) {
    std::vector<std::string> words{request.input.string()};
    const auto add = [&](const char* option, const std::string& value) {
        if (!value.empty()) words.insert(words.end(), {option, value});
    };
    add("--organ", request.organ);
    add("--label-names", request.label_names);
    add("--series", request.series);
    if (request.labels) words.emplace_back("--labels");
    for (const std::string& seed : request.seeds) words.push_back("--seed=" + seed);
    for (const std::string& seed : request.background_seeds) words.push_back("--background-seed=" + seed);
    add("--seeds-file", request.seeds_file.string());
    add("--approach", request.approach);
    if (request.contact_nodes > 0) add("--contact-nodes", fmt::format("{:g}", request.contact_nodes));
    if (request.size_mib > 0) add("--size-mib", fmt::format("{:g}", request.size_mib));
    if (request.scale)
        words.insert(words.end(), {fmt::format("--scale={:g}", *request.scale),
                                   fmt::format("--offset={:g}", request.offset)});
    add("-o", request.output.string());
    std::string command = "palpate init";
    for (const std::string& word : words) command += ' ' + quoted_for_a_shell(word);
    return command + " --yes";
}

}  // namespace palpate::commands
