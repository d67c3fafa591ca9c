// SPDX-License-Identifier: Apache-2.0
#include "runtime/apps/lesson_pages.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "runtime/visual/cautions_text.hpp"

namespace palpate::apps {
namespace {

using namespace training;
using namespace visual;

constexpr double mark_share = 0.35;  // of the tolerance: how large a mark is drawn
constexpr double least_mark = 0.8;   // mm
constexpr double line_share = 0.08;  // of the tolerance: the radius of a line

std::string clock_of(double seconds) {
    const auto whole = static_cast<int>(std::max(0.0, seconds));
    return fmt::format("{}:{:02}", whole / 60, whole % 60);
}

LessonPage start_page(const Lesson& lesson, const LessonSetting& setting) {
    LessonPage page;
    page.title = setting.case_name;
    page.text = fmt::format("Trainee: {}", setting.trainee);
    page.text += "\n" + cautions_text(setting.cautions, 76);
    int number = 0;
    for (const Exercise& exercise : lesson.exercises()) {
        ++number;
        page.choices.push_back({fmt::format("{}", number), fmt::format("{}   {}", number, exercise.title)});
    }
    page.choices.push_back({"backspace", "Backspace   Look around first, and come back"});
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

void show_places(const Exercise& exercise, const Goals& goals, bool afterwards, LessonView& view) {
    using State = LessonMark::State;
    const auto& places = exercise.places;
    const double radius = std::max(least_mark, mark_share * exercise.tolerance);
    if (exercise.task == Task::touch || exercise.task == Task::guide) {
        const bool gates = exercise.task == Task::guide;
        for (std::size_t i = 0; i < places.size(); ++i) {
            const State state = i < goals.reached    ? State::done
                                : i == goals.reached ? State::due
                                                     : State::waiting;
            const Eigen::Vector3d axis =
                places[std::min(i + 1, places.size() - 1)] - places[i > 0 ? i - 1 : 0];
            view.marks.push_back({places[i], gates ? exercise.tolerance : radius, state,
                                  gates ? axis.normalized() : Eigen::Vector3d::Zero()});
            if (gates && state == State::due && !afterwards) view.look_at = places[i];
        }
    }
    if (exercise.task == Task::find && afterwards) {
        view.marks.push_back({places.front(), radius, State::truth, Eigen::Vector3d::Zero()});
        if (goals.last_touched && goals.reached > 0)
            view.marks.push_back({*goals.last_touched, radius, State::due, Eigen::Vector3d::Zero()});
    }
    if (exercise.task == Task::trace) {
        view.line = places;
        view.line_radius = line_share * exercise.tolerance;
        double along = 0;
        for (std::size_t i = 0; i < places.size() && along <= goals.line_reached && goals.share > 0; ++i) {
            view.line_done.push_back(places[i]);
            if (i + 1 < places.size()) along += (places[i + 1] - places[i]).norm();
        }
        const Eigen::Vector3d& head = view.line_done.empty() ? places.front() : view.line_done.back();
        if (!afterwards)
            view.marks.push_back({head, 3 * view.line_radius, State::due, Eigen::Vector3d::Zero()});
    }
}

std::string progress_of(const Exercise& exercise, const Goals& goals) {
    switch (exercise.task) {
        case Task::touch:
            return fmt::format("mark {} of {}   ", goals.reached + 1, exercise.places.size());
        case Task::guide:
            return fmt::format("gate {} of {}   ", goals.reached + 1, exercise.places.size());
        case Task::trace:
            return fmt::format("{:.0f} %   ", 100 * goals.share);
        case Task::find:
        case Task::free:
            break;
    }
    return "";
}

void show_doing(const Attempt& attempt, double force, LessonView& view) {
    const Exercise& exercise = attempt.exercise();
    view.instruction = exercise.instruction;
    view.status = progress_of(exercise, attempt.goals()) +
                  clock_of(exercise.time_limit > 0 ? exercise.time_limit - attempt.time() : attempt.time()) +
                  "   Space pauses, E ends, N anew";
    view.least_force = exercise.least_force;
    view.most_force = exercise.most_force;
    if (attempt.paused())
        view.warning = "paused: Space goes on";
    else if (force > exercise.most_force)
        view.warning = fmt::format("too hard: {:.2f} N, at most {:.2f} N", force, exercise.most_force);
    else if (exercise.task == Task::trace && attempt.goals().was_astray && force >= exercise.least_force)
        view.warning = "beside the line";
    show_places(exercise, attempt.goals(), false, view);
}

}  // namespace

LessonPage result_page(const Attempt& attempt, std::span<const PastAttempt> history) {
    LessonPage page;
    page.title = attempt.exercise().title + ": " + std::string(words_of(attempt.ending()));
    const Metrics metrics = attempt.metrics();
    for_each_field(metric_fields, [&](const auto& field) {
        page.rows.emplace_back(title_of(field.name), value_of(metrics.*field.member, field.unit,
                                                              digits_of(field.unit, field.name)));
    });
    LessonCurve force{.title = "Force",
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
        LessonCurve scores{.title = "Score",
                           .x_title = "attempt",
                           .y_title = "",
                           .x = {},
                           .y = {},
                           .limit = {},
                           .most_y = 105,
                           .points = true};
        for (const PastAttempt& past : history) {
            scores.x.push_back(static_cast<double>(scores.x.size() + 1));
            scores.y.push_back(past.score);
        }
        page.curves.push_back(scores);
    }
    page.choices = {{"return", "Enter   Once more"},
                    {"space", "Space   Look at the way that the hand took"},
                    {"backspace", "Backspace   Other exercises"}};
    return page;
}

LessonView lesson_view(const Lesson& lesson, const LessonSetting& setting, double force,
                       const LessonPage& result) {
    LessonView view;
    view.hides_regions = lesson.exercising() && lesson.exercises()[lesson.chosen()].task != Task::free;
    switch (lesson.phase()) {
        case Phase::choosing:
            view.page = start_page(lesson, setting);
            break;
        case Phase::counting_down:
            view.instruction = lesson.exercises()[lesson.chosen()].instruction;
            view.status = fmt::format("begins in {:.0f}   Enter: now", std::ceil(lesson.seconds_to_begin()));
            show_places(lesson.exercises()[lesson.chosen()], {}, false, view);
            break;
        case Phase::doing:
            show_doing(*lesson.attempt(), force, view);
            break;
        case Phase::looking_back:
            if (lesson.page_hidden())
                view.status = "Space: back to the figures";
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
