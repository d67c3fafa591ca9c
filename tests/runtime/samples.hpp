// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate {

/// How many of `count` samples of one kind a test looks at: a quarter under a sanitizer, which is ten times
/// as slow and looks for what the kind does; all of them in the other presets.
constexpr int samples_of(int count) {
#ifdef PALPATE_SANITIZED
    return count / 4;
#else
    return count;
#endif
}

}  // namespace palpate
