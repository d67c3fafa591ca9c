// SPDX-License-Identifier: Apache-2.0
#include "runtime/training/lesson.hpp"

#include <algorithm>
#include <charconv>
#include <system_error>
#include <utility>

namespace palpate::training {
namespace {

// Of a digit, or of a choice that has more than one; 0: none.
std::size_t number_of(std::string_view key) {
    std::size_t number = 0;
    const char* end = key.data() + key.size();
    const auto read = std::from_chars(key.data(), end, number);
    return read.ec == std::errc{} && read.ptr == end ? number : 0;
}

}  // namespace

Lesson::Lesson(std::vector<Exercise> exercises, const Case& patient_case, double countdown, Sink ended)
    : exercises_(std::move(exercises)),
      case_(patient_case),
      countdown_(countdown),
      ended_(std::move(ended)),
      phase_(exercises_.empty() ? Phase::away : Phase::choosing) {}

void Lesson::choose(std::size_t exercise) {
    if (exercise >= exercises_.size()) return;
    chosen_ = exercise;
    to_begin_ = countdown_;
    phase_ = Phase::counting_down;
    if (countdown_ <= 0) begin();
}

void Lesson::go_away() {
    phase_ = Phase::away;
}

std::size_t Lesson::put(Exercise exercise) {
    const auto same = std::ranges::find(exercises_, exercise.name, &Exercise::name);
    const auto index = static_cast<std::size_t>(same - exercises_.begin());
    if (same == exercises_.end())
        exercises_.push_back(std::move(exercise));
    else
        *same = std::move(exercise);
    return index;
}

void Lesson::begin() {
    attempt_.emplace(exercises_[chosen_], case_);
    phase_ = Phase::doing;
}

void Lesson::press(std::string_view key) {
    switch (phase_) {
        case Phase::choosing:
            if (const std::size_t number = number_of(key); number > 0) choose(number - 1);
            if (key == "backspace") phase_ = Phase::away;
            break;
        case Phase::counting_down:
            if (key == "return") begin();
            if (key == "backspace") phase_ = Phase::choosing;
            break;
        case Phase::doing:
            if (key == "space") attempt_->pause(!attempt_->paused());
            if (key == "m") attempt_->mark_found();
            if (key == "k") attempt_->mark_border_point();
            if (key == "e" || key == "backspace") attempt_->end(Ending::ended);
            if (key == "n") {
                attempt_->end(Ending::ended);
                ended_(*attempt_);
                choose(chosen_);
            } else if (attempt_->over()) {
                look_back();
            }
            break;
        case Phase::looking_back:
            if (key == "space") page_hidden_ = !page_hidden_;
            if (key == "return" || key == "n") choose(chosen_);
            if (key == "backspace") phase_ = Phase::choosing;
            break;
        case Phase::away:
            if (key == "backspace" && !exercises_.empty()) phase_ = Phase::choosing;
            break;
    }
}

void Lesson::take(const TickResult& tick) {
    if (tick.tool != 0) return;
    const double duration = last_time_ < 0 ? 0 : tick.time - last_time_;
    last_time_ = tick.time;
    const bool pressed = (tick.buttons & 1U) != 0;
    const bool clicked = pressed && !button_;
    button_ = pressed;
    if (phase_ == Phase::counting_down) {
        to_begin_ -= duration;
        if (to_begin_ <= 0) begin();
        return;
    }
    if (phase_ != Phase::doing) return;
    attempt_->add(tick);
    if (clicked) attempt_->mark_found();
    if (attempt_->over()) look_back();
}

void Lesson::close() {
    if (phase_ != Phase::doing) return;
    attempt_->end(Ending::cut_short);
    look_back();
}

void Lesson::look_back() {
    phase_ = Phase::looking_back;
    page_hidden_ = false;
    ended_(*attempt_);
}

}  // namespace palpate::training
