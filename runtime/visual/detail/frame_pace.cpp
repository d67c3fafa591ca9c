// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/detail/frame_pace.hpp"

#include <utility>

namespace palpate::visual {

double FramePace::frame_drawn() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - std::exchange(last_, now)).count();
    ++frames_;
    if (frames_ == 2) seconds_ = seconds;
    if (frames_ > 2) seconds_ += (seconds - seconds_) / 30;
    return seconds;
}

}  // namespace palpate::visual
