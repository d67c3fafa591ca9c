// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

#include "runtime/apps/playback/recorded_scene.hpp"
#include "runtime/session/playback/playback_clock.hpp"
#include "runtime/session/session.hpp"
#include "runtime/visual/visual_frame.hpp"

namespace palpate::apps {

/// An attempt that its trainee looks at again, in the window in which it was done.
class AttemptReview {
  public:
    /// `recording`: of ticks of `run`, with its head; both must outlive it.
    AttemptReview(const recording::Recording& recording, const session::Session& run);

    /// See PlaybackClock::press().
    void press(std::string_view key) { clock_.press(key); }
    /// Whether its time goes on.
    bool runs() const { return clock_.runs(); }
    /// Jumps to a share of its time, 0 ... 1.
    void seek(double share) { clock_.seek_share(share); }
    /// Lets so many seconds pass and fills all of a frame that is not of an exercise.
    void show(double seconds, visual::VisualFrame& frame);

  private:
    RecordedScene scene_;
    session::PlaybackClock clock_;
    visual::TimelineView timeline_;
};

}  // namespace palpate::apps
