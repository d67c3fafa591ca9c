// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate {

#ifdef PALPATE_SANITIZED
inline constexpr bool sanitized = true;
#else
inline constexpr bool sanitized = false;
#endif

/// How many of `count` samples of one kind a test looks at: a quarter under a sanitizer, which is ten times
/// as slow and looks for what the kind does; all of them in the other presets.
constexpr int samples_of(int count) {
    return sanitized ? count / 4 : count;
}

}  // namespace palpate
