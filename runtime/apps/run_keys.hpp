// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "runtime/session/session.hpp"
#include "runtime/sound/force_sound.hpp"
#include "tools/cli/command.hpp"

namespace palpate::apps {

/// What keys of the trainer's window do to the run: O begins or ends a recording, A lets the force be heard,
/// F takes the next contact method, J closes a forceps' jaws or opens them.
class RunKeys {
  public:
    /// `seconds`: how much of its end a recording holds. Run and session must outlive this.
    RunKeys(session::Session& run, double seconds, const cli::Session& session)
        : run_(run), seconds_(seconds), session_(session) {}

    /// Takes a key, X11 name in lower case. `exercising`: an attempt goes on, whose contact method must stay.
    /// What to tell the user; empty for keys that mean nothing here.
    std::string press(std::string_view key, bool exercising);
    sound::ForceSound& sound() { return sound_; }
    /// Whether every tick is being kept, whoever began it.
    bool recording() const { return run_.recorded_rows().has_value(); }
    /// The recordings that were begun here.
    const std::vector<std::filesystem::path>& recordings() const { return recordings_; }

  private:
    std::string turn_recording();
    std::string take_next_method();

    session::Session& run_;
    double seconds_;
    const cli::Session& session_;
    sound::ForceSound sound_;
    std::vector<std::filesystem::path> recordings_;
};

}  // namespace palpate::apps
