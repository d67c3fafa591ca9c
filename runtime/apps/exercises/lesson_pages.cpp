// SPDX-License-Identifier: Apache-2.0
#include "runtime/apps/exercises/lesson_pages.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

#include "runtime/apps/exercises/exercise_marks.hpp"
#include "runtime/texts/translated.hpp"
#include "runtime/visual/cautions_text.hpp"

namespace palpate::apps {
namespace {

using namespace training;
using namespace visual;
using texts::looked_up;
using texts::translated;

constexpr double look_tolerances = 2;  // of the gates' tolerance: how far ahead a scope looks

std::string clock_of(double seconds) {
    const auto whole = static_cast<int>(std::max(0.0, seconds));
    return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

// As the exercise lies before it begins: what is hidden stays so.
LessonPicture picture_of(const Exercise& exercise) {
    LessonView view;
    show_places(exercise, {}, false, view);
    return {.marks = std::move(view.marks), .line = std::move(view.line), .line_radius = view.line_radius};
}

LessonPage start_page(const Lesson& lesson, const LessonSetting& setting) {
    LessonPage page;
    page.title = setting.case_name;
    page.text = translated("Trainee: {}", setting.trainee);
    page.text += "\n" + cautions_text(setting.cautions, 76);
    page.picture = LessonPicture{.whole = true};
    int number = 0;
    for (const Exercise& exercise : lesson.exercises()) {
        ++number;
        page.choices.push_back({std::to_string(number),
                                fmt::format("{}   {}", number, looked_up(exercise.title.c_str())),
                                picture_of(exercise)});
    }
    page.choices.push_back({"f2", "F2   " + translated("Make an exercise of your own")});
    page.choices.push_back({"f3", "F3   " + translated("Another trainee")});
    page.choices.push_back(
        {"backspace", translated("Backspace") + "   " + translated("Look around first, and come back")});
    return page;
}

std::string value_of(double value, const char* unit, int digits) {
    if (!std::isfinite(value)) return "\u2013";
    return fmt::format("{:.{}f}{}{}", value, digits, *unit != '\0' ? " " : "", unit);
}

int digits_of(const std::string& unit, const std::string& name) {
    if (name == "score" || name == "misses") return 0;
    return name != "tremor" && (unit == "mm" || unit == "s") ? 1 : 2;
}

std::string progress_of(const Exercise& exercise, const Goals& goals) {
    switch (exercise.task) {
        case Task::touch:
            return translated("mark {} of {}   ", goals.reached + 1, exercise.places.size());
        case Task::guide:
            return translated("gate {} of {}   ", goals.reached + 1, exercise.places.size());
        case Task::trace:
            return fmt::format("{:.0f} %   ", 100 * goals.share);
        case Task::find:
            return goals.border.empty() ? "" : translated("{} border points   ", goals.border.size());
        case Task::retract:
            return goals.reached > 0 ? translated("let it go   ")
                                     : translated("kept {:.1f} of {:.1f} s   ", goals.held, exercise.hold);
        case Task::free:
            break;
    }
    return "";
}

// The key as people call it, and what it does.
LessonChoice action(const char* key, const std::string& called, const std::string& does) {
    return {key, called + "  " + does};
}

std::vector<LessonChoice> actions_of(Task task, bool paused) {
    std::vector<LessonChoice> actions{
        action("space", translated("Space"), paused ? translated("Go on") : translated("Pause")),
        action("e", "E", translated("End")), action("n", "N", translated("Anew"))};
    if (task == Task::find) {
        actions.push_back(action("k", "K", translated("A point of its border")));
        actions.push_back(action("m", "M", translated("It is here")));
    }
    return actions;
}

// Along the line of the gates, also where the one that is due is behind a bend.
void look_ahead(const Exercise& exercise, std::size_t due, const Eigen::Vector3d& tip, LessonView& view) {
    if (exercise.task != Task::guide) return;
    view.look_at = point_ahead(exercise.places, tip, due, look_tolerances * exercise.tolerance);
}

void show_doing(const Attempt& attempt, double force, const Eigen::Vector3d& tip, LessonView& view) {
    const Exercise& exercise = attempt.exercise();
    view.instruction = looked_up(exercise.instruction.c_str());
    view.status = progress_of(exercise, attempt.goals()) +
                  clock_of(exercise.time_limit > 0 ? exercise.time_limit - attempt.time() : attempt.time());
    view.actions = actions_of(exercise.task, attempt.paused());
    view.least_force = exercise.least_force;
    view.most_force = exercise.most_force;
    if (exercise.task == Task::touch || exercise.task == Task::find || exercise.task == Task::trace)
        view.press_force = (exercise.least_force + exercise.most_force) / 2;
    if (attempt.paused())
        view.warning = translated("paused");
    else if (force > exercise.most_force)
        view.warning = translated("too hard: {:.2f} N, at most {:.2f} N", force, exercise.most_force);
    else if (exercise.task == Task::trace && attempt.goals().was_astray && force >= exercise.least_force)
        view.warning = translated("beside the line");
    show_places(exercise, attempt.goals(), false, view);
    look_ahead(exercise, attempt.goals().reached, tip, view);
}

}  // namespace

LessonPage result_page(const Attempt& attempt, bool watchable, std::span<const PastAttempt> history) {
    LessonPage page;
    page.title = std::string(looked_up(attempt.exercise().title.c_str())) + ": " +
                 std::string(looked_up(words_of(attempt.ending()).data()));
    const Metrics metrics = attempt.metrics();
    for_each_field(metric_fields, [&](const auto& field) {
        page.rows.emplace_back(
            looked_up(title_of(field.name).c_str()),
            value_of(metrics.*field.member, field.unit, digits_of(field.unit, field.name)));
    });
    LessonCurve force{.title = translated("Force"),
                      .x_title = "s",
                      .y_title = "N",
                      .x = {},
                      .y = {},
                      .limit = attempt.exercise().most_force,
                      .most_y = {},
                      .points = false};
    for (const Sample& sample : attempt.samples()) {
        force.x.push_back(sample.time);
        force.y.push_back(sample.force);
    }
    page.curves.push_back(force);
    if (!history.empty()) {
        LessonCurve scores{.title = translated("Score"),
                           .x_title = translated("attempt"),
                           .y_title = "",
                           .x = {},
                           .y = {},
                           .limit = {},
                           .most_y = 100,
                           .points = true};
        for (const PastAttempt& past : history) {
            scores.x.push_back(static_cast<double>(scores.x.size() + 1));
            scores.y.push_back(past.score);
        }
        page.curves.push_back(scores);
    }
    page.choices = {{"return", translated("Enter") + "   " + translated("Once more")},
                    {"space", translated("Space") + "   " + translated("Look at the way that the hand took")},
                    {"f2", "F2   " + translated("Change this exercise")},
                    {"backspace", translated("Backspace") + "   " + translated("Other exercises")}};
    if (watchable)
        page.choices.insert(page.choices.begin() + 2, {"f4", "F4   " + translated("Watch it again")});
    return page;
}

LessonView trainee_view(const std::string& typed, const LessonSetting& setting) {
    LessonView view;
    view.takes_keys = true;
    view.page.emplace();
    view.page->title = setting.case_name;
    view.page->text = translated("Trainee: {}", typed + "_") + "\n" +
                      translated("A pseudonym, under which attempts are kept: letters, digits, - and _");
    view.page->choices = {{"Return", translated("Enter") + "   " + translated("Take it")},
                          {"Escape", translated("Esc") + "   " + translated("Stay {}", setting.trainee)}};
    return view;
}

void show_review(LessonView& view) {
    view.page.reset();
    view.takes_keys = true;
    view.actions = {action("f4", "F4", translated("Back to the figures"))};
}

LessonView lesson_view(const Lesson& lesson, const LessonSetting& setting, double force,
                       const Eigen::Vector3d& tip, const LessonPage& result) {
    LessonView view;
    view.hides_regions = lesson.exercising() && lesson.exercises()[lesson.chosen()].task != Task::free;
    switch (lesson.phase()) {
        case Phase::choosing:
            view.page = start_page(lesson, setting);
            break;
        case Phase::counting_down: {
            const Exercise& exercise = lesson.exercises()[lesson.chosen()];
            view.instruction = looked_up(exercise.instruction.c_str());
            view.status = translated("begins in {:.0f}", std::ceil(lesson.seconds_to_begin()));
            view.actions = {action("return", translated("Enter"), translated("Now")),
                            action("f2", "F2", translated("Change it"))};
            show_places(exercise, {}, false, view);
            // The hand is drawn back to where it begins, and looks where it will go.
            look_ahead(exercise, exercise.places.size() - 1, tip, view);
            break;
        }
        case Phase::doing:
            show_doing(*lesson.attempt(), force, tip, view);
            break;
        case Phase::looking_back:
            if (lesson.page_hidden())
                view.actions = {action("space", translated("Space"), translated("Back to the figures"))};
            else
                view.page = result;
            show_places(lesson.attempt()->exercise(), lesson.attempt()->goals(), true, view);
            for (const Sample& sample : lesson.attempt()->samples()) view.path.push_back(sample.position);
            break;
        case Phase::away:
            break;
    }
    return view;
}

}  // namespace palpate::apps
