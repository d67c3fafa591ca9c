// SPDX-License-Identifier: Apache-2.0
#include "runtime/training/attempt.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "formats/records/shown_text.hpp"
#include "runtime/training/touched_place.hpp"

namespace palpate::training {
namespace {

using Eigen::Vector3d;

constexpr double usual_period = 0.001;  // s, of a tick that follows none

// From where the hand was through the places that were reached, mm.
double shortest_way(const Exercise& exercise, const Goals& goals, const Vector3d& start) {
    if (exercise.task == Task::trace) return goals.line_reached;
    if (exercise.task == Task::retract) return length_of({start, exercise.places[1], exercise.places[2]});
    std::vector<Vector3d> way{start};
    for (std::size_t i = 0; i < goals.reached; ++i) way.push_back(exercise.places[i]);
    return length_of(way);
}

}  // namespace

std::string_view words_of(Ending ending) {
    switch (ending) {
        case Ending::not_yet:
            return shown_text("not yet");
        case Ending::all_reached:
            return shown_text("all reached");
        case Ending::found:
            return shown_text("found");
        case Ending::not_found:
            return shown_text("not found");
        case Ending::time_is_up:
            return shown_text("time is up");
        case Ending::ended:
            return shown_text("ended");
        case Ending::cut_short:
            break;
    }
    return shown_text("cut short");
}

bool came_to_its_end(Ending ending) {
    return reached_all(ending) || ending == Ending::not_found || ending == Ending::time_is_up;
}

bool reached_all(Ending ending) {
    return ending == Ending::all_reached || ending == Ending::found;
}

Attempt::Attempt(Exercise exercise, const Case& patient_case)
    : exercise_(std::move(exercise)), case_(patient_case) {}

void Attempt::add(const TickResult& tick) {
    if (over() || paused_ || tick.tool != 0) {
        if (tick.tool == 0) last_tick_time_ = -1;
        return;
    }
    const double duration = last_tick_time_ < 0 ? usual_period : std::max(0.0, tick.time - last_tick_time_);
    last_tick_time_ = tick.time;
    time_ += duration;
    const double force = Eigen::Map<const Vector3d>(tick.force.data()).norm();
    peak_force_ = std::max(peak_force_, force);
    if (has_its_force(tick) && force > 0 && force >= exercise_.least_force) {
        in_contact_ += duration;
        impulse_ += force * duration;
    }
    if (force > exercise_.most_force) above_limit_ += duration;
    sample(tick, force, duration);
    follow(exercise_,
           {.duration = duration,
            .force = force,
            .tool = Eigen::Map<const Vector3d>(tick.tool_position.data()),
            .touched = touched_place(case_, tick),
            .force_is_the_tissues = has_its_force(tick)},
           goals_);
    if (goals_.reached_all)
        end(Ending::all_reached);
    else if (exercise_.time_limit > 0 && time_ >= exercise_.time_limit)
        end(Ending::time_is_up);
}

void Attempt::sample(const TickResult& tick, double force, double duration) {
    sum_.position += Eigen::Map<const Vector3d>(tick.device_position.data());
    sum_.force += force;
    sum_.depth += tick.depth;
    ++summed_ticks_;
    summed_time_ += duration;
    if (summed_time_ < sample_period * (1 - 1e-6)) return;
    samples_.push_back({.time = time_,
                        .position = sum_.position / summed_ticks_,
                        .force = sum_.force / summed_ticks_,
                        .depth = sum_.depth / summed_ticks_});
    sum_ = {};
    summed_time_ = 0;
    summed_ticks_ = 0;
}

void Attempt::pause(bool on) {
    paused_ = on;
}

void Attempt::mark_found() {
    if (over() || paused_) return;
    mark(exercise_, goals_);
    if (goals_.reached_all) end(goals_.misses == 0 ? Ending::found : Ending::not_found);
}

void Attempt::mark_border_point() {
    if (!over() && !paused_) mark_border(exercise_, goals_);
}

void Attempt::end(Ending ending) {
    if (!over()) ending_ = ending;
}

Metrics Attempt::metrics() const {
    Metrics m;
    m.time = time_;
    m.path_length = path_length(samples_);
    m.log_dimensionless_jerk = log_dimensionless_jerk(samples_);
    m.spectral_arc_length = spectral_arc_length(samples_);
    m.tremor = tremor(samples_);
    m.peak_force = peak_force_;
    m.mean_force = in_contact_ > 0 ? impulse_ / in_contact_ : 0;
    m.time_in_contact = in_contact_;
    m.time_above_limit = above_limit_;
    m.misses = static_cast<double>(goals_.misses);
    if (exercise_.task == Task::free) {
        m.goals = m.score = not_defined;
        return m;
    }
    m.goals = goals_.share;
    const double care = in_contact_ > 0 ? 1 - above_limit_ / in_contact_ : 1;
    m.score = 100 * m.goals * std::clamp(care, 0.0, 1.0);
    if (const auto count = static_cast<double>(goals_.error_count); count > 0)
        m.position_error =
            exercise_.task == Task::trace ? std::sqrt(goals_.squared_errors / count) : goals_.errors / count;
    m.border_error = border_error(exercise_, goals_);
    const bool has_way = exercise_.task != Task::find && goals_.share > 0 && m.path_length > 0;
    if (has_way)
        m.economy_of_motion = shortest_way(exercise_, goals_, samples_.front().position) / m.path_length;
    return m;
}

}  // namespace palpate::training
