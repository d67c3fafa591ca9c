// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/detail/detail_control.hpp"

#include <algorithm>

namespace palpate::visual {
namespace {

constexpr double slowest = 1.0 / 32;                  // s a frame: less detail before 30 a second are lost
constexpr double far_over = 2.5;                      // times that: two levels at once
constexpr double roomy = 1.0 / 48;                    // s a frame: there may be room for more
constexpr double decision_seconds = 0.35;             // of frames, from which one decision is made,
constexpr std::size_t least_frames = 4;               // and how many they are at least
constexpr int skipped_frames = 2;                     // after a change
constexpr double first_wait = 4, longest_wait = 120;  // s
constexpr double trial = 5;                           // s that a level must last

}  // namespace

DetailControl::DetailControl(int levels)
    : levels_(levels), level_(levels), to_skip_(skipped_frames), wait_(first_wait) {}

bool DetailControl::take(double seconds) {
    if (to_skip_ > 0) {
        --to_skip_;
        return false;
    }
    frames_.push_back(seconds);
    gathered_ += seconds;
    if (gathered_ < decision_seconds || frames_.size() < least_frames) return false;
    const auto middle = frames_.begin() + static_cast<std::ptrdiff_t>(frames_.size() / 2);
    std::ranges::nth_element(frames_, middle);
    const double usual = *middle;
    roomy_ = usual < roomy ? roomy_ + gathered_ : 0;
    lasted_ += gathered_;
    if (trying_ && lasted_ > trial) {
        trying_ = false;
        wait_ = first_wait;
    }
    frames_.clear();
    gathered_ = 0;
    if (usual > slowest) return change(level_ - (usual > far_over * slowest ? 2 : 1));
    if (roomy_ >= wait_) return change(level_ + 1);
    return false;
}

bool DetailControl::change(int level) {
    level = std::clamp(level, 1, levels_);
    if (level == level_) return false;
    if (trying_ && level < level_) wait_ = std::min(longest_wait, 2 * wait_);
    trying_ = level > level_;
    level_ = level;
    lasted_ = roomy_ = 0;
    to_skip_ = skipped_frames;
    ++changes_;
    return true;
}

}  // namespace palpate::visual
