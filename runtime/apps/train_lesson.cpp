// SPDX-License-Identifier: Apache-2.0
#include "runtime/apps/train_lesson.hpp"

#include <algorithm>
#include <cstdlib>
#include <fmt/chrono.h>
#include <fstream>
#include <spdlog/spdlog.h>
#include <utility>

#include "formats/model/errors.hpp"
#include "runtime/training/lay_out.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/staged_file.hpp"

namespace palpate::apps {
namespace {

using namespace training;

constexpr double countdown = 3;  // s

std::string now_utc() {
    return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(std::time(nullptr)));
}

// "20260301T093000Z_touch", with a number behind it where there is such a file.
std::filesystem::path free_name(const std::filesystem::path& folder, std::string when,
                                const std::string& exercise) {
    std::erase_if(when, [](char letter) { return letter == '-' || letter == ':'; });
    std::filesystem::path path = folder / (when + "_" + exercise);
    for (int number = 2; std::filesystem::exists(path.string() + ".json"); ++number)
        path = folder / fmt::format("{}_{}-{}", when, exercise, number);
    return path;
}

std::size_t index_of(const std::string& name, const std::vector<Exercise>& exercises) {
    const auto found = std::ranges::find(exercises, name, &Exercise::name);
    if (found != exercises.end()) return static_cast<std::size_t>(found - exercises.begin());
    std::string names;
    for (const Exercise& exercise : exercises) names += (names.empty() ? "" : ", ") + exercise.name;
    throw UsageError({"--exercise", "no exercise '" + name + "'", names, ""});
}

}  // namespace

std::filesystem::path usual_attempts_folder() {
    if (const char* data = std::getenv("XDG_DATA_HOME"); data != nullptr && *data != '\0')
        return std::filesystem::path(data) / "palpate/attempts";
    if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0')
        return std::filesystem::path(home) / ".local/share/palpate/attempts";
    return "palpate-attempts";
}

std::vector<Exercise> lay_out_exercises(const LessonOptions& options, session::Session& run,
                                        const session::TouchTarget& start) {
    if (!is_pseudonym(options.trainee))
        throw UsageError({"--trainee", "'" + options.trainee + "'", "1 to 40 letters, digits, '-' and '_'",
                          "a pseudonym, not a name"});
    const bool standard = options.exercises.empty();
    std::vector<Exercise> exercises;
    for (const ExerciseRecipe& recipe : standard ? standard_exercises() : read_exercises(options.exercises)) {
        try {
            if (auto exercise = lay_out(recipe, run.patient_case(), run.model(), start))
                exercises.push_back(std::move(*exercise));
        } catch (const InvalidInput& error) {
            if (!standard) throw;
            spdlog::info("without the exercise '{}': {}", recipe.title, error.what());
        }
    }
    if (!options.exercise.empty()) index_of(options.exercise, exercises);
    return exercises;
}

TrainLesson::TrainLesson(const LessonOptions& options, std::vector<Exercise> exercises,
                         const session::Session& run, LessonSetting setting, bool scripted)
    : folder_((options.attempts.empty() ? usual_attempts_folder() : std::filesystem::path(options.attempts)) /
              options.trainee),
      setting_(std::move(setting)),
      run_(run),
      lesson_(std::move(exercises), run.patient_case(), scripted ? 0 : countdown,
              [this](const Attempt& attempt) { keep(attempt); }) {
    if (!options.exercise.empty())
        lesson_.choose(index_of(options.exercise, lesson_.exercises()));
    else if (scripted)
        lesson_.go_away();
}

std::optional<Eigen::Vector3d> TrainLesson::hand(const Eigen::Vector3d& now) {
    const bool back =
        lesson_.phase() == Phase::counting_down && lesson_.exercises()[lesson_.chosen()].task == Task::guide;
    if (!back) {
        way_back_.clear();
        return std::nullopt;
    }
    if (way_back_.empty()) {
        const auto& gates = lesson_.exercises()[lesson_.chosen()].places;
        const auto nearest = std::ranges::min_element(
            gates, {}, [&](const Eigen::Vector3d& gate) { return (gate - now).norm(); });
        way_back_.assign(std::make_reverse_iterator(nearest + 1), gates.rend());
        way_back_.insert(way_back_.begin(), now);
    }
    constexpr double arrives_before = 0.5;  // s, before the attempt begins
    const double share = 1 - (lesson_.seconds_to_begin() - arrives_before) / (countdown - arrives_before);
    return point_along(way_back_, std::clamp(share, 0.0, 1.0) * length_of(way_back_));
}

void TrainLesson::keep(const Attempt& attempt) {
    const AttemptHead head{.trainee = setting_.trainee,
                           .when = now_utc(),
                           .case_name = setting_.case_name,
                           .device = run_.device_name(),
                           .scheme = std::string(run_.model().method().name),
                           .version = cli::version()};
    attempts_.push_back(attempt_json(head, attempt));
    try {
        std::filesystem::create_directories(folder_);
        const std::filesystem::path path = free_name(folder_, head.when, attempt.exercise().name);
        cli::write_text_file(path.string() + ".csv", attempt_csv(attempt), false);
        cli::write_text_file(path.string() + ".json", attempts_.back().dump(2) + "\n", false);
        std::ofstream(folder_ / "statements.jsonl", std::ios::app)
            << xapi_statement(head, attempt).dump() << '\n';
        attempts_.back()["file"] = path.filename().string() + ".json";
    } catch (const std::exception& error) {
        spdlog::warn("the attempt is not kept: {}", error.what());
    }
    result_ =
        result_page(attempt, read_history(folder_, head.case_name, attempt.exercise().name,
                                          [](const std::string& sentence) { spdlog::warn("{}", sentence); }));
}

}  // namespace palpate::apps
