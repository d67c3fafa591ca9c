// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>

#include "runtime/haptics/haptic_model.hpp"
#include "runtime/session/playback/recorded_surfaces.hpp"
#include "runtime/session/playback/recorded_track.hpp"
#include "runtime/visual/sight.hpp"
#include "runtime/visual/tools/other_tool.hpp"
#include "runtime/visual/visual_frame.hpp"

namespace palpate::apps {

/// A recorded tool as one beside another.
visual::OtherTool other_tool_of(const Tick& tick);
/// The other jaw of a forceps that is held, without its force: that is in what the hand feels.
visual::OtherTool other_jaw_of(const Tick& tick);

/// What the window shows of a recording at any moment: the run's own positions, forces, contacts and flags;
/// nothing is computed again but the surfaces that those contacts deform. Recording, model and case must
/// outlive it.
class RecordedScene {
  public:
    /// Shows tool `tool`, others beside it. Throws InvalidInput naming `file` as track_of() and
    /// check_contacts().
    RecordedScene(const recording::Recording& recording, const std::filesystem::path& file, std::int32_t tool,
                  const haptics::HapticModel& model, const Case& patient_case);

    const session::RecordedTrack& track() const { return track_; }
    /// What the hand feels in a tick of the track, N: of a forceps, whose other jaw is beside it, both jaws'
    /// force.
    Eigen::Vector3d felt(const Tick& tick) const;
    /// From where its first contact is seen; where nothing is touched, what a fresh trainer would show.
    visual::Sight sight() const;
    /// Fills everything but what is of a window, an exercise, a ghost or a timeline. Returns the tick that is
    /// shown.
    const Tick& fill(visual::VisualFrame& frame, double time);

  private:
    const recording::Recording& recording_;
    const haptics::HapticModel& model_;
    const Case& case_;
    session::RecordedTrack track_;
    std::vector<session::RecordedTrack> others_;
    session::RecordedSurfaces surfaces_;
};

}  // namespace palpate::apps
