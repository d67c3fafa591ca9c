// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <ctime>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "runtime/apps/exercises/attempt_review.hpp"
#include "runtime/apps/exercises/lesson_pages.hpp"
#include "runtime/session/playback/run_excerpt.hpp"
#include "runtime/session/session.hpp"
#include "runtime/session/touch_target.hpp"
#include "runtime/training/lay_out.hpp"
#include "runtime/training/lesson.hpp"
#include "runtime/training/teacher/exercise_editor.hpp"

namespace palpate::apps {

/// What of a command line is about exercises.
struct LessonOptions {
    std::filesystem::path exercises;  ///< a file; empty: `usual` and the standard ones
    std::filesystem::path usual;      ///< the asset's own, which need not be there: usual_exercise_file()
    std::string exercise;             ///< to begin with; empty: the start page
    std::string trainee = "guest";    ///< a pseudonym
    std::string attempts;             ///< folder for results; empty: usual_attempts_folder()
};

/// $XDG_DATA_HOME/palpate/attempts, or ~/.local/share/palpate/attempts; where neither variable is set, a
/// folder of that name here.
std::filesystem::path usual_attempts_folder();

/// An exercise as it was asked for and as it lies on the patient.
struct LaidOut {
    training::ExerciseRecipe recipe;
    training::Exercise exercise;
};

/// Lays the exercises out on the session's patient, around `start` and in the eye's sight. Those of a file
/// that cannot be are refused if the user named it; of the asset's own and the standard ones those that find
/// no room on this patient are left out, and said. After hold(), before the loops run. Throws as
/// read_exercises(), lay_out(); UsageError for a pseudonym that is none or an exercise that is not there.
std::vector<LaidOut> lay_out_exercises(const LessonOptions& options, session::Session& run,
                                       const session::TouchTarget& start, const training::FirstEye& eye);

/// The exercises of one run of the trainer, their attempts and the files that keep them, and the making of
/// new ones.
class TrainLesson {
  public:
    /// `scripted`: a script holds the device, so that an exercise that is asked for begins at once, and no
    /// page is shown without one.
    TrainLesson(const LessonOptions& options, const std::vector<LaidOut>& exercises,
                const session::Session& run, LessonSetting setting, bool scripted);
    TrainLesson(const TrainLesson&) = delete;
    TrainLesson& operator=(const TrainLesson&) = delete;

    /// A key, or a page's choice, while `tick` is felt: "f2" begins to make an exercise on the start page,
    /// and to change the chosen one while it counts down or is looked back at, see ExerciseEditor then; "f3"
    /// there begins to type another pseudonym; "f4" has an attempt that is looked back at shown again, see
    /// AttemptReview then, until "F4", "BackSpace" or "Escape"; see Lesson for all others.
    void press(const std::string& key, const TickResult& tick);
    /// Takes a tick of any tool as its device felt it, before take() gets what the hand felt.
    void record(const TickResult& tick);
    /// Takes a tick of any tool, see Lesson; while marks are set, a press of the lowest button sets one.
    void take(const TickResult& tick);
    const training::Lesson& lesson() const { return lesson_; }
    /// An attempt that is shown again, in place of what is felt; null: none.
    AttemptReview* review() { return review_ ? &*review_ : nullptr; }
    /// Cuts an attempt short and keeps it.
    void close() { lesson_.close(); }
    /// `force`: N, on the device; `tip`: of the tool, p_P, mm.
    visual::LessonView view(double force, const Eigen::Vector3d& tip) const;
    /// Where a hand that mouse and keyboard guide is to be while a guided passage counts down: on the way
    /// back through its gates to the first. `now`: where it is, p_P, mm.
    std::optional<Eigen::Vector3d> hand(const Eigen::Vector3d& now);
    /// All attempts so far, as attempt_json() has them.
    const nlohmann::ordered_json& attempts() const { return attempts_; }

  private:
    void keep(const training::Attempt& attempt);
    void keep_recording(const std::filesystem::path& path);
    void begin_to_edit();
    void type_trainee(const std::string& key);
    void look_again(std::string key);
    void grant(training::Wish wish);
    std::optional<training::Exercise> lay_out_draft();

    std::vector<Eigen::Vector3d> way_back_;  // empty but while that countdown goes on

    std::filesystem::path attempts_folder_;  // of all trainees
    LessonSetting setting_;
    std::optional<std::string> typed_trainee_;  // while it is typed
    const session::Session& run_;
    visual::LessonPage result_;  // of the last attempt
    nlohmann::ordered_json attempts_ = nlohmann::ordered_json::array();
    training::Lesson lesson_;

    std::vector<training::ExerciseRecipe> recipes_;  // of the lesson's exercises
    std::filesystem::path exercise_file_;            // keeps what a teacher makes
    std::vector<std::string> written_;               // names in it at first, also of what found no room here
    std::optional<training::ExerciseEditor> editor_;
    training::Exercise draft_;             // as the editor has it
    bool button_ = false;                  // at the last tick
    std::optional<std::time_t> began_;     // of the attempt that goes on
    session::RunExcerpt excerpt_;          // of that
    recording::Recording last_;            // of the last one; empty: none that could be kept
    std::optional<AttemptReview> review_;  // of that
};

}  // namespace palpate::apps
