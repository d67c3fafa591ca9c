// SPDX-License-Identifier: Apache-2.0
#include "runtime/apps/exercises/exercise_marks.hpp"

#include <algorithm>

namespace palpate::apps {

using namespace training;
using namespace visual;

namespace {

constexpr double mark_share = 0.35;   // of the tolerance: how large a mark is drawn
constexpr double least_mark = 0.8;    // mm
constexpr double line_share = 0.08;   // of the tolerance: the radius of a line
constexpr double border_share = 0.4;  // of a mark: how large a point of a border is drawn

}  // namespace

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
        }
    }
    if (exercise.task == Task::retract) {
        const State take = goals.was_drawn || goals.reached > 0 ? State::done : State::due;
        if (places.empty()) return;  // as long as a teacher has set none
        view.marks.push_back({places[0], 2 * radius, take, Eigen::Vector3d::Zero()});
        if (places.size() < 3) return;
        const Eigen::Vector3d pull = places[2] - places[1];
        view.marks.push_back({places[0] + pull, 2 * exercise.tolerance,
                              goals.reached > 0 ? State::done : State::due, pull.normalized()});
    }
    if (exercise.task == Task::find) {
        for (const Eigen::Vector3d& point : goals.border)
            view.marks.push_back({point, border_share * radius, State::due, Eigen::Vector3d::Zero()});
        if (!afterwards) return;
        view.marks.push_back({places.front(), radius, State::truth, Eigen::Vector3d::Zero()});
        view.outline = exercise.outline;
        view.line_radius = line_share * exercise.tolerance;
        if (goals.last_touched && goals.reached > 0)
            view.marks.push_back({*goals.last_touched, radius, State::due, Eigen::Vector3d::Zero()});
    }
    if (exercise.task == Task::trace && !places.empty()) {
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

}  // namespace palpate::apps
