// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>

namespace palpate {

/// A posture that has a name, and which way gravity points in it, frame P (LPS).
struct NamedPosture {
    const char* name;
    std::array<double, 3> down;
};

inline constexpr std::array<NamedPosture, 5> named_postures{{{"supine", {0, 1, 0}},
                                                             {"prone", {0, -1, 0}},
                                                             {"left_side", {1, 0, 0}},
                                                             {"right_side", {-1, 0, 0}},
                                                             {"upright", {0, 0, -1}}}};

}  // namespace palpate
