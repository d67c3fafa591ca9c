// SPDX-License-Identifier: Apache-2.0
#include "runtime/sound/force_pitch.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::sound {

Tone tone_of(double newtons) {
    constexpr double silent = 0.01, loudest = 0.03, low = 0.02;  // N
    constexpr double low_pitch = 110, high_pitch = 2200;         // Hz
    return {.pitch = std::clamp(low_pitch * std::sqrt(newtons / low), low_pitch / 2, high_pitch),
            .loudness = std::clamp((newtons - silent) / (loudest - silent), 0.0, 1.0)};
}

}  // namespace palpate::sound
