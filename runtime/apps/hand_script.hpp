// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "runtime/devices/hand_path.hpp"

namespace palpate {

/// Whether a script is one that is made to measure for a place on the surface ("press", "slide") rather than
/// a file of positions.
bool is_made_to_measure(const std::string& script);

/// The path of "press" or "slide" at a place.
HandPath made_to_measure_path(const std::string& script, const TouchPoint& place,
                              const ScriptSettings& settings);

/// The path in a file; throws InvalidInput if there is neither such a script nor such a file, or as
/// read_hand_path().
HandPath recorded_path(const std::string& script);

}  // namespace palpate
