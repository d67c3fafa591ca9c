// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "runtime/visual/actors.hpp"

namespace palpate {

/// Relative luminance, ITU-R BT.709, of a colour taken as linear; 0 ... 255.
inline float luminance(const visual::Rgb& colour) {
    return 0.2126F * colour[0] + 0.7152F * colour[1] + 0.0722F * colour[2];
}

}  // namespace palpate
