// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "formats/model/body.hpp"
#include "formats/records/tick_result.hpp"
#include "runtime/training/attempt.hpp"
#include "runtime/training/exercise.hpp"

namespace palpate::training {

/// Where a trainee is between start page and result.
enum class Phase {
    choosing,       ///< on the start page
    counting_down,  ///< an exercise begins in a moment
    doing,          ///< an attempt runs, or is paused
    looking_back,   ///< on the result page
    away,           ///< nothing is over the scene: no exercise, until the start page is asked for
};

/// The way through the exercises: chooses, counts down, runs attempts, hands each to `ended` when it is over.
/// Keys are X11 names in lower case: a digit chooses (beyond 9 a
/// page's number), "return" begins (again), "space" pauses and goes on,
/// "m" answers a search, "k" sets a point of the border before, "e" ends, "n" does it anew, after it "space"
/// hides the result page and shows it again, "backspace" goes to the start page and away from it. One thread.
/// The case must outlive it.
class Lesson {
  public:
    using Sink = std::function<void(const Attempt&)>;

    /// `countdown`: s. Begins on the start page, or away from it if there is no exercise.
    Lesson(std::vector<Exercise> exercises, const Case& patient_case, double countdown, Sink ended);

    /// Begins an exercise as if it had been chosen; `exercise` counts from 0.
    void choose(std::size_t exercise);
    /// Leaves the start page, or whatever else is shown, without an exercise.
    void go_away();
    /// Adds an exercise, or puts it in the place of the one of its name; returns its index. Not while an
    /// attempt runs.
    std::size_t put(Exercise exercise);
    /// A key, or a page's choice; others do nothing.
    void press(std::string_view key);
    /// Takes a tick of any tool. A press of the lowest device button answers a search.
    void take(const TickResult& tick);
    /// Cuts an attempt short and hands it out.
    void close();

    Phase phase() const { return phase_; }
    /// An attempt counts down, goes on or is paused.
    bool exercising() const { return phase_ == Phase::counting_down || phase_ == Phase::doing; }
    const std::vector<Exercise>& exercises() const { return exercises_; }
    /// The exercise that was chosen last.
    std::size_t chosen() const { return chosen_; }
    double seconds_to_begin() const { return to_begin_; }  ///< while counting down
    bool page_hidden() const { return page_hidden_; }      ///< while looking back
    /// The attempt that runs or was looked back at; null before the first.
    const Attempt* attempt() const { return attempt_ ? &*attempt_ : nullptr; }

  private:
    void begin();
    void look_back();

    std::vector<Exercise> exercises_;
    const Case& case_;
    double countdown_;
    Sink ended_;
    Phase phase_;
    std::size_t chosen_ = 0;
    double to_begin_ = 0;
    double last_time_ = -1;  // s, of the last tick
    bool button_ = false;    // at the last tick
    bool page_hidden_ = false;
    std::optional<Attempt> attempt_;
};

}  // namespace palpate::training
