// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <cstdint>

namespace palpate::visual {

/// How many frames were drawn, and how fast they come.
class FramePace {
  public:
    /// A frame has been drawn; returns how long after the one before, s, which says nothing of the first.
    double frame_drawn();

    std::int64_t frames() const { return frames_; }
    /// Averaged over some thirty frames; 0 before the second.
    double per_second() const { return seconds_ > 0 ? 1 / seconds_ : 0; }

  private:
    std::int64_t frames_ = 0;
    double seconds_ = 0;  // of a frame
    std::chrono::steady_clock::time_point last_{};
};

}  // namespace palpate::visual
