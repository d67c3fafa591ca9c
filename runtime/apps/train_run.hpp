// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <optional>

#include "runtime/apps/exercises/train_lesson.hpp"
#include "runtime/apps/playback/expert_ghost.hpp"
#include "runtime/apps/run_keys.hpp"
#include "runtime/realtime/histogram.hpp"
#include "runtime/session/session.hpp"
#include "runtime/visual/train_window.hpp"

namespace palpate::apps {

/// Everything felt since the start, and how far the first device went.
struct Felt {
    double force_peak = 0;  ///< N
    double depth_peak = 0;  ///< mm
    double travel = 0;      ///< mm
    std::optional<Eigen::Vector3d> last_position{};

    void add(const TickResult& tick);
};

/// A session in its window.
struct TrainRun {
    session::Session& session;
    visual::TrainWindow& window;
    TrainLesson& lesson;
    RunKeys& keys;
    const ExpertGhost* ghost = nullptr;  ///< null: none
    bool shows_shaft = false;            ///< a person's hand turns the first tool
    double seconds = 0;                  ///< after which it ends; 0: when the user says so
};

/// What came of it.
struct TrainOutcome {
    realtime::Histogram frame_ns;
    realtime::Histogram late_ns;  ///< how old the tick is that a frame shows, once it is on the screen
    double seconds = 0;
    Felt felt;
};

/// Starts the session and shows it until the user, an interrupt, a lost window or the time ends it; then ends
/// session and attempt. `frame` has a place for every deformable body's displacements. Throws as
/// Session::start(); SystemFailure if the servo stands still.
TrainOutcome run_in_window(const TrainRun& run, visual::VisualFrame& frame);

}  // namespace palpate::apps
