// SPDX-License-Identifier: Apache-2.0
#include "runtime/apps/exercises/train_lesson.hpp"

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <fmt/chrono.h>
#include <fstream>
#include <spdlog/spdlog.h>
#include <utility>

#include "formats/model/arrays.hpp"
#include "formats/model/errors.hpp"
#include "runtime/apps/exercises/editor_view.hpp"
#include "runtime/apps/exercises/save_exercise.hpp"
#include "runtime/session/jaws/grasp_place.hpp"
#include "runtime/texts/translated.hpp"
#include "runtime/training/lay_out.hpp"
#include "runtime/training/statements.hpp"
#include "runtime/training/touched_place.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/outputs/staged_file.hpp"

namespace palpate::apps {
namespace {

using namespace training;

constexpr double countdown = 3;  // s

std::string utc(std::time_t time) {
    return fmt::format("{:%Y-%m-%dT%H:%M:%SZ}", fmt::gmtime(time));
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

std::size_t index_of(const std::string& name, const std::vector<LaidOut>& exercises) {
    std::string names;
    for (std::size_t i = 0; i < exercises.size(); ++i) {
        if (exercises[i].recipe.name == name) return i;
        names += (names.empty() ? "" : ", ") + exercises[i].recipe.name;
    }
    throw UsageError({"--exercise", "no exercise '" + name + "'", names, ""});
}

std::vector<ExerciseRecipe> written_in(const std::filesystem::path& file) {
    return std::filesystem::exists(file) ? read_exercises(file) : std::vector<ExerciseRecipe>{};
}

// The asset's own that are for what is held, and the standard ones, which count where the asset has none of
// their name that finds room.
std::vector<ExerciseRecipe> usual_exercises(const std::filesystem::path& file, bool with_forceps) {
    std::vector<ExerciseRecipe> recipes = written_in(file);
    const std::vector<Task> served = tasks_of(with_forceps);
    std::erase_if(recipes, [&](const ExerciseRecipe& recipe) {
        return std::ranges::find(served, recipe.task) == served.end();
    });
    std::ranges::move(standard_exercises(with_forceps), std::back_inserter(recipes));
    return recipes;
}

// Whether tissue is pressed from two sides: much of what presses it takes each other away.
bool is_held(const TickResult& tick, std::size_t rigid_count) {
    constexpr double left = 0.7;
    double sum = 0;
    Eigen::Vector3d together = Eigen::Vector3d::Zero();
    for (const Contact& contact : tick.active_contacts()) {
        if (is_of_neighbour(contact) || contact.body < static_cast<std::int32_t>(rigid_count)) continue;
        sum += contact.force;
        together += contact.force * normal_of(contact);
    }
    return sum > 0 && together.norm() < left * sum;
}

// Over the tips of a forceps that holds tissue.
std::optional<Eigen::Vector3d> held_rim(const session::Session& run, const TickResult& tick) {
    if (!run.jaws() || !is_held(tick, run.patient_case().rigid_bodies.size())) return std::nullopt;
    return vector_of(tick.tool_position) +
           session::grasp_depth(run.jaws()->jaw_length) * vector_of(tick.shaft).normalized();
}

std::vector<std::string> names_of_hidden(const Case& patient_case) {
    std::vector<std::string> names;
    for (const HiddenRegion& region : hidden_regions(patient_case)) names.push_back(region.name);
    names.erase(std::unique(names.begin(), names.end()), names.end());  // a search takes the first of a name
    return names;
}

std::vector<Exercise> exercises_of(const std::vector<LaidOut>& laid_out) {
    std::vector<Exercise> exercises;
    for (const LaidOut& each : laid_out) exercises.push_back(each.exercise);
    return exercises;
}

}  // namespace

std::filesystem::path usual_attempts_folder() {
    if (const char* data = std::getenv("XDG_DATA_HOME"); data != nullptr && *data != '\0')
        return std::filesystem::path(data) / "palpate/attempts";
    if (const char* home = std::getenv("HOME"); home != nullptr && *home != '\0')
        return std::filesystem::path(home) / ".local/share/palpate/attempts";
    return "palpate-attempts";
}

std::vector<LaidOut> lay_out_exercises(const LessonOptions& options, session::Session& run,
                                       const session::TouchTarget& start, const FirstEye& eye) {
    if (!is_pseudonym(options.trainee))
        throw UsageError({"--trainee", "'" + options.trainee + "'", "1 to 40 letters, digits, '-' and '_'",
                          "a pseudonym, not a name"});
    const bool named = !options.exercises.empty();
    std::vector<LaidOut> exercises;
    for (const ExerciseRecipe& recipe :
         named ? read_exercises(options.exercises) : usual_exercises(options.usual, run.jaws().has_value())) {
        if (recipe.task == Task::retract && !run.jaws())
            throw InvalidInput({recipe.written_at, "task 'retract' without a forceps", "",
                                "start with --instrument forceps, or leave it out"});
        const auto same = [&](const LaidOut& other) { return other.recipe.name == recipe.name; };
        if (!named && std::ranges::any_of(exercises, same)) continue;
        try {
            if (auto exercise = lay_out(recipe, run.patient_case(), run.model(), start, eye))
                exercises.push_back({recipe, std::move(*exercise)});
        } catch (const InvalidInput& error) {
            if (named) throw;
            spdlog::info("without the exercise '{}': {}", recipe.title, error.what());
        }
    }
    if (!options.exercise.empty()) index_of(options.exercise, exercises);
    return exercises;
}

TrainLesson::TrainLesson(const LessonOptions& options, const std::vector<LaidOut>& exercises,
                         const session::Session& run, LessonSetting setting, bool scripted)
    : attempts_folder_(options.attempts.empty() ? usual_attempts_folder()
                                                : std::filesystem::path(options.attempts)),
      setting_(std::move(setting)),
      run_(run),
      lesson_(exercises_of(exercises), run.patient_case(), scripted ? 0 : countdown,
              [this](const Attempt& attempt) { keep(attempt); }),
      exercise_file_(options.exercises.empty() ? options.usual : options.exercises) {
    for (const LaidOut& exercise : exercises) recipes_.push_back(exercise.recipe);
    for (const ExerciseRecipe& recipe : written_in(exercise_file_)) written_.push_back(recipe.name);
    if (!options.exercise.empty())
        lesson_.choose(index_of(options.exercise, exercises));
    else if (scripted)
        lesson_.go_away();
}

void TrainLesson::press(const std::string& key, const TickResult& tick) {
    if (typed_trainee_) return type_trainee(key);
    if (review_) return look_again(key);
    if (!editor_) {
        if (key == "f2")
            begin_to_edit();
        else if (key == "f3" && lesson_.phase() == Phase::choosing)
            typed_trainee_.emplace();
        else if (key == "f4" && lesson_.phase() == Phase::looking_back && !last_.ticks.empty())
            review_.emplace(last_, run_);
        else
            lesson_.press(key);
        return;
    }
    const HandNow hand{.tool = vector_of(tick.tool_position),
                       .force = vector_of(tick.force).norm(),
                       .touched = touched_place(run_.patient_case(), tick),
                       .rim = held_rim(run_, tick)};
    grant(editor_->press(key, hand));
    if (editor_) draft_ = lay_out_draft().value_or(Exercise{});
}

// As X11 names keys, in any case.
void TrainLesson::look_again(std::string key) {
    std::ranges::transform(key, key.begin(), [](unsigned char letter) { return std::tolower(letter); });
    if (key == "f4" || key == "backspace" || key == "escape")
        review_.reset();
    else
        review_->press(key);
}

// As X11 names keys. What would make no pseudonym is not taken.
void TrainLesson::type_trainee(const std::string& key) {
    std::string& name = *typed_trainee_;
    if (key == "BackSpace" && !name.empty()) name.pop_back();
    if (const char letter = typed_letter(key); is_pseudonym(name + letter)) name += letter;
    if (key == "Return" && !name.empty()) setting_.trainee = name;
    if (key == "Return" || key == "Escape") typed_trainee_.reset();
}

void TrainLesson::begin_to_edit() {
    if (lesson_.exercises().empty()) return;
    const Exercise& chosen = lesson_.exercises()[lesson_.chosen()];
    Choices choices{.tasks = tasks_of(run_.jaws().has_value()),
                    .regions = names_of_hidden(run_.patient_case())};
    if (lesson_.phase() == Phase::counting_down || lesson_.phase() == Phase::looking_back) {
        editor_.emplace(settled(recipes_[lesson_.chosen()], chosen), choices);
    } else if (lesson_.phase() == Phase::choosing) {
        for (const ExerciseRecipe& recipe : recipes_) choices.taken.push_back(recipe.name);
        choices.taken.insert(choices.taken.end(), written_.begin(), written_.end());
        ExerciseRecipe fresh;
        fresh.task = choices.tasks.front();
        fresh.least_force = chosen.least_force;
        fresh.most_force = chosen.most_force;
        const auto exercise = lay_out_settled(fresh, run_.patient_case(), run_.model());
        editor_.emplace(settled(fresh, *exercise), choices);
    } else {
        return;
    }
    lesson_.go_away();
    draft_ = lay_out_draft().value_or(Exercise{});
}

std::optional<Exercise> TrainLesson::lay_out_draft() {
    try {
        auto exercise = lay_out_settled(editor_->recipe(), run_.patient_case(), run_.model());
        if (!exercise) editor_->tell(texts::translated("nothing is hidden in this case"));
        return exercise;
    } catch (const InvalidInput& error) {
        editor_->tell(error.what());
        return std::nullopt;
    }
}

void TrainLesson::grant(Wish wish) {
    if (wish == Wish::nothing) return;
    if (wish == Wish::leave) {
        editor_.reset();
        lesson_.press("backspace");  // to the start page
        return;
    }
    const ExerciseRecipe recipe = editor_->recipe();
    const auto exercise = lay_out_draft();
    if (!exercise) return;
    try {
        if (wish == Wish::save) {
            save_exercise(exercise_file_, recipe);
            editor_->tell(texts::translated("saved to {}", exercise_file_.string()));
        }
    } catch (const std::exception& error) {
        editor_->tell(cli::with_final_names(error.what()));
        return;
    }
    const std::size_t index = lesson_.put(*exercise);
    recipes_.resize(lesson_.exercises().size());
    recipes_[index] = recipe;
    if (wish == Wish::save) return;
    editor_.reset();
    lesson_.choose(index);
}

void TrainLesson::record(const TickResult& tick) {
    if (lesson_.phase() != Phase::doing) return;
    if (!began_) began_ = std::time(nullptr);
    excerpt_.add(tick);
}

void TrainLesson::take(const TickResult& tick) {
    lesson_.take(tick);
    if (tick.tool != 0) return;
    const bool pressed = (tick.buttons & 1U) != 0;
    if (pressed && !button_ && editor_ && !editor_->page_shown()) press("m", tick);
    button_ = pressed;
}

visual::LessonView TrainLesson::view(double force, const Eigen::Vector3d& tip) const {
    if (typed_trainee_) return trainee_view(*typed_trainee_, setting_);
    if (editor_) return editor_view(*editor_, draft_, exercise_file_.filename().string());
    visual::LessonView view = lesson_view(lesson_, setting_, force, tip, result_);
    if (review_) show_review(view);
    return view;
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

// What there is of the attempt to be looked at; `path` keeps it, if it can.
void TrainLesson::keep_recording(const std::filesystem::path& path) {
    recording::Recording recording = excerpt_.take();
    const auto is_shown = [](const Tick& tick) { return tick.tool == 0; };
    if (std::ranges::none_of(recording.ticks, is_shown)) return;
    const std::int32_t every = recording.head.every;
    try {
        recording.head = run_.recording_head(cli::version());
        recording.head.every = every;
        last_ = std::move(recording);
        cli::StagedFile file(path, false);
        recording::write_recording(file.path(), last_);
        file.commit();
        attempts_.back()["recording"] = path.filename().string();
    } catch (const std::exception& error) {
        spdlog::warn("the attempt's recording is not kept: {}", cli::with_final_names(error.what()));
    }
}

void TrainLesson::keep(const Attempt& attempt) {
    const std::time_t now = std::time(nullptr);
    const auto begun = std::exchange(began_, std::nullopt);
    const AttemptHead head{.trainee = setting_.trainee,
                           .began = utc(begun.value_or(now)),
                           .when = utc(now),
                           .case_name = setting_.case_name,
                           .device = run_.device_name(),
                           .scheme = std::string(run_.model().method().name),
                           .version = cli::version()};
    attempts_.push_back(attempt_json(head, attempt));
    last_ = {};
    const std::filesystem::path folder = attempts_folder_ / head.trainee;
    try {
        std::filesystem::create_directories(folder);
        const std::filesystem::path path = free_name(folder, head.when, attempt.exercise().name);
        cli::write_text_file(path.string() + ".csv", attempt_csv(attempt), false);
        keep_recording(path.string() + ".h5");
        cli::write_text_file(path.string() + ".json", attempts_.back().dump(2) + "\n", false);
        std::ofstream statements(folder / "statements.jsonl", std::ios::app);
        for (const nlohmann::ordered_json& statement : statements_of(head, attempt))
            statements << statement.dump() << '\n';
        attempts_.back()["file"] = path.filename().string() + ".json";
    } catch (const std::exception& error) {
        spdlog::warn("the attempt is not kept: {}", error.what());
    }
    result_ = result_page(attempt, !last_.ticks.empty(),
                          read_history(folder, head.case_name, attempt.exercise().name,
                                       [](const std::string& sentence) { spdlog::warn("{}", sentence); }));
}

}  // namespace palpate::apps
