// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>

#include "runtime/devices/hand_path.hpp"

namespace palpate {

/// Whether a script is one that is made to measure for a place on the surface ("press", "slide", "random")
/// rather than a file of positions.
bool is_made_to_measure(const std::string& script);

/// The path of "press", "slide" or "random" at a place; `seed` is of the last.
HandPath made_to_measure_path(const std::string& script, const TouchPoint& place,
                              const ScriptSettings& settings, std::uint64_t seed);

/// The path in a file; throws InvalidInput if there is neither such a script nor such a file, or as
/// read_hand_path().
HandPath recorded_path(const std::string& script);

}  // namespace palpate
