// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <functional>
#include <string>
#include <string_view>

namespace palpate::cli {

struct Session;

/// Asks the person at the terminal, where there is one at stdin and stderr; elsewhere, with --quiet, or where
/// it is to take proposals, each question has its proposal for an answer. Not thread-safe.
class Questions {
  public:
    /// What must hold of an answer: throws an Error, which is told before the question is asked again.
    using Check = std::function<void(const std::string&)>;

    /// `session` must outlive this; its progress bar ends before a question.
    Questions(Session& session, bool take_proposals);

    /// Whether anybody is asked.
    bool asks() const noexcept { return asks_; }
    /// "`question` [`proposal`]: " and the line that is typed, without blanks at its ends; the proposal for
    /// an empty one. Throws Interrupted where the input ends.
    std::string ask(std::string_view question, const std::string& proposal, const Check& check = {});

  private:
    Session& session_;
    bool asks_;
};

}  // namespace palpate::cli
