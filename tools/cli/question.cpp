// SPDX-License-Identifier: Apache-2.0
#include "tools/cli/question.hpp"

#include <fmt/format.h>
#include <iostream>
#include <unistd.h>

#include "tools/cli/command.hpp"

namespace palpate::cli {
namespace {

std::string trimmed(const std::string& line) {
    const auto first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos) return "";
    return line.substr(first, line.find_last_not_of(" \t\r") + 1 - first);
}

}  // namespace

Questions::Questions(Session& session, bool take_proposals)
    : session_(session),
      asks_(!take_proposals && !session.quiet && isatty(STDIN_FILENO) == 1 && isatty(STDERR_FILENO) == 1) {}

std::string Questions::ask(std::string_view question, const std::string& proposal, const Check& check) {
    if (!asks_) return proposal;
    session_.progress.finish();
    for (;;) {
        std::cerr << question << (proposal.empty() ? ": " : fmt::format(" [{}]: ", proposal)) << std::flush;
        std::string line;
        if (!std::getline(std::cin, line)) throw Interrupted{};
        const std::string answer = trimmed(line).empty() ? proposal : trimmed(line);
        try {
            if (check) check(answer);
            if (!answer.empty()) return answer;
        } catch (const Error& error) {
            std::cerr << error.what() << '\n';
        }
    }
}

}  // namespace palpate::cli
