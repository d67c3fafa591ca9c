// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "runtime/apps/lesson_pages.hpp"
#include "runtime/session/session.hpp"
#include "runtime/session/touch_target.hpp"
#include "runtime/training/lesson.hpp"

namespace palpate::apps {

/// What of a command line is about exercises.
struct LessonOptions {
    std::filesystem::path exercises;  ///< a file; empty: the standard ones
    std::string exercise;             ///< to begin with; empty: the start page
    std::string trainee = "guest";    ///< a pseudonym
    std::string attempts;             ///< folder for results; empty: usual_attempts_folder()
};

/// $XDG_DATA_HOME/palpate/attempts, or ~/.local/share/palpate/attempts; where neither variable is set, a
/// folder of that name here.
std::filesystem::path usual_attempts_folder();

/// Lays the exercises out on the session's patient, around `start`. Of the standard ones those that find no
/// room on this patient are left out, and said; those of a file that cannot be are refused. After hold(),
/// before the loops run. Throws as read_exercises(), lay_out(); UsageError for a pseudonym that is none or an
/// exercise that is not there.
std::vector<training::Exercise> lay_out_exercises(const LessonOptions& options, session::Session& run,
                                                  const session::TouchTarget& start);

/// The exercises of one run of the trainer, their attempts and the files that keep them.
class TrainLesson {
  public:
    /// `scripted`: a script holds the device, so that an exercise that is asked for begins at once, and no
    /// page is shown without one.
    TrainLesson(const LessonOptions& options, std::vector<training::Exercise> exercises,
                const session::Session& run, LessonSetting setting, bool scripted);
    TrainLesson(const TrainLesson&) = delete;
    TrainLesson& operator=(const TrainLesson&) = delete;

    training::Lesson& lesson() { return lesson_; }
    visual::LessonView view(double force) const { return lesson_view(lesson_, setting_, force, result_); }
    /// Where a hand that mouse and keyboard guide is to be while a guided passage counts down: on the way
    /// back through its gates to the first. `now`: where it is, p_P, mm.
    std::optional<Eigen::Vector3d> hand(const Eigen::Vector3d& now);
    /// All attempts so far, as attempt_json() has them.
    const nlohmann::ordered_json& attempts() const { return attempts_; }

  private:
    void keep(const training::Attempt& attempt);

    std::vector<Eigen::Vector3d> way_back_;  // empty but while that countdown goes on

    std::filesystem::path folder_;
    LessonSetting setting_;
    const session::Session& run_;
    visual::LessonPage result_;  // of the last attempt
    nlohmann::ordered_json attempts_ = nlohmann::ordered_json::array();
    training::Lesson lesson_;
};

}  // namespace palpate::apps
