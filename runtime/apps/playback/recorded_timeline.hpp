// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "runtime/apps/playback/recorded_scene.hpp"
#include "runtime/session/playback/playback_clock.hpp"
#include "runtime/visual/playback/playback_view.hpp"

namespace palpate::apps {

/// The force over a recording's time, for the line below the scene.
visual::TimelineView timeline_of(const RecordedScene& scene);

/// Puts a clock's time and speed on it. `filmed`: a clock that stands still is no pause.
void show_time(const session::PlaybackClock& clock, bool filmed, visual::TimelineView& timeline);

}  // namespace palpate::apps
