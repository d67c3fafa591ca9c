// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <cmath>

namespace palpate::devices {

/// Tells a glitch of encoders that are read in every tick from a hand: a position that nobody reaches in the
/// time since the last plausible one. What stays there is plausible after as long as the way takes at the
/// highest speed. Realtime-safe.
class SpeedWatch {
  public:
    static constexpr double fastest =
        5000;                               ///< mm/s; five times the fastest hand of `palpate bench puncture`
    static constexpr double period = 1e-3;  ///< s, that two positions are apart at the least

    /// Whether a hand may be at `position` (mm) at `time` (s), and if so, remembers it.
    bool plausible(const std::array<double, 3>& position, double time) noexcept {
        const double way = std::hypot(position[0] - last_[0], position[1] - last_[1], position[2] - last_[2]);
        if (seen_ && !(way <= fastest * std::max(period, time - time_))) return false;
        last_ = position;
        time_ = time;
        seen_ = true;
        return true;
    }

  private:
    std::array<double, 3> last_{};  // mm
    double time_ = 0;               // s
    bool seen_ = false;
};

}  // namespace palpate::devices
