// SPDX-License-Identifier: Apache-2.0
#include "runtime/apps/hand_script.hpp"

#include <filesystem>

#include "formats/model/errors.hpp"

namespace palpate {

bool is_made_to_measure(const std::string& script) {
    return script == "press" || script == "slide";
}

HandPath made_to_measure_path(const std::string& script, const TouchPoint& place,
                              const ScriptSettings& settings) {
    return script == "press" ? press_path(place, settings) : slide_path(place, settings);
}

HandPath recorded_path(const std::string& script) {
    if (!std::filesystem::exists(script))
        throw InvalidInput(
            {script, "no such script or file", "press, slide or a file of positions", "check the path"});
    return read_hand_path(script);
}

}  // namespace palpate
