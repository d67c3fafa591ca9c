// SPDX-License-Identifier: Apache-2.0
#include "runtime/apps/exercises/attempt_review.hpp"

#include "runtime/apps/playback/recorded_timeline.hpp"

namespace palpate::apps {

AttemptReview::AttemptReview(const recording::Recording& recording, const session::Session& run)
    : scene_(recording, "attempt", 0, run.model(), run.patient_case()),
      clock_(scene_.track().front()->time, scene_.track().back()->time, 1),
      timeline_(timeline_of(scene_)) {}

void AttemptReview::show(double seconds, visual::VisualFrame& frame) {
    clock_.advance(seconds);
    scene_.fill(frame, clock_.time());
    show_time(clock_, false, timeline_);
    frame.timeline = timeline_;
}

}  // namespace palpate::apps
