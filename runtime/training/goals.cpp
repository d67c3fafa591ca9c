// SPDX-License-Identifier: Apache-2.0
#include "runtime/training/goals.hpp"

#include <algorithm>

#include "runtime/training/metrics.hpp"
#include "runtime/training/region_outline.hpp"

namespace palpate::training {
namespace {

using Eigen::Vector3d;

void add_error(double error, Goals& goals) {
    goals.errors += error;
    goals.squared_errors += error * error;
    ++goals.error_count;
}

// At the first of several gates an attempt begins: who stays there has reached nothing.
void reach_next(const Exercise& exercise, Goals& goals) {
    const std::size_t begins = exercise.task == Task::guide && exercise.places.size() > 1 ? 1 : 0;
    ++goals.reached;
    goals.share =
        static_cast<double>(goals.reached - begins) / static_cast<double>(exercise.places.size() - begins);
    goals.reached_all = goals.reached == exercise.places.size();
}

// A press that never came to the mark that was due, nor stayed on the one before, is a miss.
void follow_marks(const Exercise& exercise, const Moment& moment, bool touching, Goals& goals) {
    const auto near = [&](std::size_t place) {
        return place < exercise.places.size() && moment.touched &&
               (*moment.touched - exercise.places[place]).norm() <= exercise.tolerance;
    };
    if (touching && !goals.was_touching) goals.was_astray = true;
    if (!touching && goals.was_touching && goals.was_astray) ++goals.misses;
    if (touching && (near(goals.reached) || (goals.reached > 0 && near(goals.reached - 1))))
        goals.was_astray = false;
    if (!touching || !near(goals.reached)) {
        goals.held = 0;
        return;
    }
    goals.held += moment.duration;
    if (goals.held < exercise.hold) return;
    add_error((*moment.touched - exercise.places[goals.reached]).norm(), goals);
    goals.held = 0;
    reach_next(exercise, goals);
}

// The tool is at this distance from the last gate.
void come_closer(double distance, Goals& goals) {
    if (distance >= goals.nearest) return;
    goals.errors += distance - goals.nearest;
    goals.squared_errors += distance * distance - goals.nearest * goals.nearest;
    goals.nearest = distance;
}

void follow_gates(const Exercise& exercise, const Moment& moment, Goals& goals) {
    const bool hurts = moment.force > exercise.most_force;
    if (hurts && !goals.was_astray) ++goals.misses;
    goals.was_astray = hurts;
    const auto distance_to = [&](std::size_t gate) { return (moment.tool - exercise.places[gate]).norm(); };
    if (goals.reached > 0) come_closer(distance_to(goals.reached - 1), goals);
    const double distance = distance_to(goals.reached);
    if (distance > exercise.tolerance) return;
    const bool ends = goals.reached > 0 && goals.reached + 1 == exercise.places.size();
    if (!ends) add_error(goals.nearest = distance, goals);
    reach_next(exercise, goals);
}

void follow_line(const Exercise& exercise, const Moment& moment, bool touching, Goals& goals) {
    if (!touching || !moment.touched) return;
    const double length = length_of(exercise.places), reach = 2 * exercise.tolerance;
    const LinePoint nearest =
        nearest_on_line(exercise.places, *moment.touched, std::max(0.0, goals.line_reached - reach),
                        std::min(length, goals.line_reached + reach));
    const bool begun = goals.error_count > 0;
    const bool astray = nearest.distance > exercise.tolerance;
    if (astray && begun && !goals.was_astray) ++goals.misses;
    goals.was_astray = astray;
    if (begun || !astray) add_error(nearest.distance, goals);
    if (astray) return;
    goals.line_reached = std::max(goals.line_reached, nearest.along);
    goals.share = goals.line_reached / length;
    goals.reached_all = length - goals.line_reached <= exercise.tolerance;
    if (goals.reached_all) goals.share = 1;
}

// What is held is the tissue that is touched, at rest: it lies between the rim and the jaws' tips, until it
// slips.
void follow_retraction(const Exercise& exercise, const Moment& moment, bool touching, Goals& goals) {
    constexpr double between = 0.7;  // of the way from rim to tips
    const Vector3d &rim = exercise.places[0], &tips = exercise.places[1], &there = exercise.places[2];
    const bool holds = touching && moment.touched &&
                       (*moment.touched - (rim + tips) / 2).norm() <= between * (rim - tips).norm();
    const bool drawn = (moment.tool - tips).norm() > exercise.tolerance;
    if (goals.reached == 0) {
        if (goals.was_drawn && drawn && !holds) ++goals.misses;
        goals.was_drawn = holds && drawn;
        const double error = (moment.tool - there).norm();
        goals.held = holds && error <= exercise.tolerance ? goals.held + moment.duration : 0;
        if (goals.held < exercise.hold) return;
        add_error(error, goals);
        goals.reached = 1;
        goals.share = 0.5;
    } else if (moment.force == 0) {
        goals.reached = 2;
        goals.share = 1;
        goals.reached_all = true;
    }
}

}  // namespace

void follow(const Exercise& exercise, const Moment& moment, Goals& goals) {
    if (goals.reached_all) return;
    if (!moment.force_is_the_tissues && exercise.task != Task::guide) return;
    const bool touching = moment.force >= exercise.least_force;
    if (touching && moment.touched) goals.last_touched = moment.touched;
    switch (exercise.task) {
        case Task::touch:
            follow_marks(exercise, moment, touching, goals);
            break;
        case Task::guide:
            follow_gates(exercise, moment, goals);
            break;
        case Task::trace:
            follow_line(exercise, moment, touching, goals);
            break;
        case Task::retract:
            follow_retraction(exercise, moment, touching, goals);
            break;
        case Task::find:
        case Task::free:
            break;
    }
    goals.was_touching = touching;
}

void mark(const Exercise& exercise, Goals& goals) {
    if (exercise.task != Task::find || !goals.last_touched || goals.reached_all) return;
    const double error = (*goals.last_touched - exercise.places.front()).norm();
    add_error(error, goals);
    if (error > exercise.tolerance) ++goals.misses;
    goals.share = std::clamp(1 - (error - exercise.tolerance) / (2 * exercise.tolerance), 0.0, 1.0);
    goals.reached = 1;
    goals.reached_all = true;
}

void mark_border(const Exercise& exercise, Goals& goals) {
    if (exercise.task != Task::find || !goals.last_touched || goals.reached_all) return;
    goals.border.push_back(*goals.last_touched);
}

double border_error(const Exercise& exercise, const Goals& goals) {
    if (exercise.outline.empty() || goals.border.empty()) return not_defined;
    double sum = 0;
    for (const Vector3d& point : goals.border) sum += distance_to_outline(exercise.outline, point);
    return sum / static_cast<double>(goals.border.size());
}

}  // namespace palpate::training
