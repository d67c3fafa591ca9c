// SPDX-License-Identifier: Apache-2.0
#include "runtime/session/playback/playback_clock.hpp"

#include <algorithm>

namespace palpate::session {

PlaybackClock::PlaybackClock(double begins, double ends, double speed)
    : begins_(begins), ends_(ends), time_(begins), speed_(speed) {}

void PlaybackClock::advance(double seconds) {
    if (!runs_) return;
    time_ = std::min(time_ + speed_ * seconds, ends_);
    runs_ = time_ < ends_;
}

void PlaybackClock::seek(double time) {
    time_ = std::clamp(time, begins_, ends_);
}

void PlaybackClock::press(std::string_view key) {
    constexpr double step = 0.1;  // s
    if (key == "space") {
        runs_ = !runs_;
        if (runs_ && time_ >= ends_) time_ = begins_;
    }
    if (key == "comma") speed_ = std::max(slowest, speed_ / 2);
    if (key == "period") speed_ = std::min(fastest, speed_ * 2);
    if (key == "left" || key == "right") {
        runs_ = false;
        seek(time_ + (key == "left" ? -step : step) * speed_);
    }
    if (key == "home") seek(begins_);
    if (key == "end") seek(ends_);
}

}  // namespace palpate::session
