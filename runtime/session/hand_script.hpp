// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>

#include "runtime/devices/hand_path.hpp"

namespace palpate::session {

/// Whether a script is one that is made to measure for a place on the surface ("press", "slide", "tremble",
/// "let-go", "random"; of a forceps grasp_script) rather than a file.
bool is_made_to_measure(const std::string& script);

/// The path of such a script, but for a forceps', at a place; `seed` is of "random" and "tremble".
devices::HandPath made_to_measure_path(const std::string& script, const devices::TouchPoint& place,
                                       const devices::ScriptSettings& settings, std::uint64_t seed);

/// The path in a file; throws InvalidInput if there is neither such a script nor such a file, if it has
/// angles of jaws and is not of a forceps or has none and is, or as read_hand_path().
devices::HandPath recorded_path(const std::string& script, bool of_forceps = false);

/// The path that one recorded axis in a file makes at a place, as recorded_axis_path() and read_column().
/// Throws UsageError if the script is made to measure, InvalidInput if there is no such file.
devices::HandPath recorded_axis_path(const std::string& script, std::size_t column,
                                     const devices::TouchPoint& place,
                                     const devices::ScriptSettings& settings);

}  // namespace palpate::session
