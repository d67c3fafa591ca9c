// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate::sound {

/// What a force sounds like.
struct Tone {
    double pitch = 0;     ///< Hz
    double loudness = 0;  ///< 0 to 1
};

/// An octave for each fourfold force, 110 Hz at 0.02 N: what a device renders, up to 8 N, keeps within 2.2
/// kHz, and two places whose stiffness differs by a tenth lie more than a quarter tone apart. Silent up to
/// 0.01 N, at its loudest from 0.03 N on. `newtons` is not negative.
Tone tone_of(double newtons);

}  // namespace palpate::sound
