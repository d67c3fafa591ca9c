// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <utility>
#include <vector>

#include "runtime/visual/controls/open_window.hpp"
#include "tools/cli/command.hpp"

namespace palpate::apps {

/// What of the trainer's command line is about recordings that are looked at.
struct PlaybackOptions {
    std::filesystem::path play;             ///< a recording; empty: the trainer trains
    std::filesystem::path ghost;            ///< of an expert's run; empty: none
    std::filesystem::path video, pictures;  ///< where a film of the recording goes; empty: nowhere
    int tool = 0;                           ///< the one that is shown as held
    double speed = 1;                       ///< 1: as it was
    int film_rate = 30;                     ///< pictures a second
};

/// What else of that command line counts while a recording is shown.
struct PlaybackWindow {
    std::filesystem::path asset;
    std::vector<std::string>
        trusted_keys;  ///< one of which must have signed it; none: no signature is asked for
    std::optional<visual::WindowSize> size;  ///< pixels; if not given, as open_window() has it
    double seconds = 0;                      ///< s, after which it closes; 0: when told to
    std::filesystem::path screenshot;        ///< at the end; empty: none
};

/// Adds the options to the command. `beside`: others of its options that count beside --play. Returns a
/// check for after the command line has been read: throws UsageError for any other beside --play.
std::function<void()> declare_playback(cli::Command& command, PlaybackOptions& options,
                                       std::vector<cli::Option> beside);

/// Shows a recording in the trainer's window until the user or the time ends it, or films it from beginning
/// to end as fast as the machine draws. No device is held and no servo runs. Throws InvalidInput if the
/// recording is of another asset or damaged; as FilmOutput; Interrupted if a film's window was closed before
/// its end.
nlohmann::ordered_json play_recording(const PlaybackOptions& options, const PlaybackWindow& shown,
                                      cli::Session& session);

}  // namespace palpate::apps
