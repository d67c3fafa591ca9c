// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <optional>
#include <vector>

#include "runtime/session/playback/recorded_track.hpp"
#include "runtime/training/lesson.hpp"
#include "runtime/visual/tools/other_tool.hpp"

namespace palpate::apps {

/// A recorded run of an expert, whose first tool, or both jaws of a forceps, is shown as a ghost beside one's
/// own. Its time zero is the beginning of its session::Demonstration: a second before its first contact.
class ExpertGhost {
  public:
    /// Reads the recording in `file` of a run on `asset`. Throws as read_recording() and check_asset().
    ExpertGhost(const std::filesystem::path& file, const std::filesystem::path& asset);
    ExpertGhost(const ExpertGhost&) = delete;
    ExpertGhost& operator=(const ExpertGhost&) = delete;

    /// The ghost `time` s after its zero; before that it waits, after its end it stays. Logarithmic in the
    /// recording.
    std::vector<visual::OtherTool> at(double time) const;
    /// Beside a trainee: with the attempt's own time while one runs, so that it pauses with it; waiting while
    /// one counts down; round and round in free exploration, `time` s after the run's start. None while a
    /// page asks for a choice or shows a result.
    std::vector<visual::OtherTool> beside(const training::Lesson& lesson, double time) const;

    const session::Demonstration& demonstration() const { return demonstration_; }

  private:
    std::vector<visual::OtherTool> ghost_at(double moment) const;  // s, of the recording

    recording::Recording recording_;
    session::RecordedTrack track_;
    std::optional<session::RecordedTrack> other_jaw_;
    session::Demonstration demonstration_;
};

}  // namespace palpate::apps
