// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string_view>
#include <vector>

#include "formats/model/body.hpp"
#include "formats/records/tick_result.hpp"
#include "runtime/training/exercise.hpp"
#include "runtime/training/goals.hpp"
#include "runtime/training/metrics.hpp"

namespace palpate::training {

/// How an attempt ended.
enum class Ending {
    not_yet,
    all_reached,  ///< every goal
    found,        ///< a search: the trainee's answer is near enough ...
    not_found,    ///< ... or is not
    time_is_up,
    ended,      ///< by the trainee
    cut_short,  ///< by a closed window, an interrupt or a fault
};

/// "not yet", "all reached", "found", "not found", "time is up", "ended", "cut short".
std::string_view words_of(Ending ending);
/// Whether nobody broke it off.
bool came_to_its_end(Ending ending);
/// Whether all that was asked for was reached.
bool reached_all(Ending ending);

/// One trainee at one exercise: takes the ticks of the first tool, follows the goals, keeps what metrics are
/// computed from. One thread. The case must outlive it.
class Attempt {
  public:
    /// Begins at once.
    Attempt(Exercise exercise, const Case& patient_case);

    /// Takes a tick; while paused or over, nothing of it counts.
    void add(const TickResult& tick);
    void pause(bool on);
    /// find: the answer, see mark() of goals.hpp.
    void mark_found();
    /// find: a point of the border, see mark_border() of goals.hpp.
    void mark_border_point();
    void end(Ending ending);

    const Exercise& exercise() const { return exercise_; }
    const Goals& goals() const { return goals_; }
    Ending ending() const { return ending_; }
    bool over() const { return ending_ != Ending::not_yet; }
    bool paused() const { return paused_; }
    double time() const { return time_; }  ///< s
    std::span<const Sample> samples() const { return samples_; }
    Metrics metrics() const;

  private:
    void sample(const TickResult& tick, double force, double duration);

    Exercise exercise_;
    const Case& case_;
    Goals goals_;
    Ending ending_ = Ending::not_yet;
    bool paused_ = false;
    double last_tick_time_ = -1;  // s; below 0: of a tick that does not count
    double time_ = 0, peak_force_ = 0, impulse_ = 0, in_contact_ = 0, above_limit_ = 0;
    std::vector<Sample> samples_;
    Sample sum_;  // of the ticks since the last sample
    double summed_time_ = 0;
    int summed_ticks_ = 0;
};

}  // namespace palpate::training
