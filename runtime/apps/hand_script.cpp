// SPDX-License-Identifier: Apache-2.0
#include "runtime/apps/hand_script.hpp"

#include <filesystem>

#include "formats/model/errors.hpp"

namespace palpate {

bool is_made_to_measure(const std::string& script) {
    return script == "press" || script == "slide" || script == "random";
}

HandPath made_to_measure_path(const std::string& script, const TouchPoint& place,
                              const ScriptSettings& settings, std::uint64_t seed) {
    if (script == "press") return press_path(place, settings);
    return script == "slide" ? slide_path(place, settings) : random_path(place, settings, seed);
}

HandPath recorded_path(const std::string& script) {
    if (!std::filesystem::exists(script))
        throw InvalidInput({script, "no such script or file", "press, slide, random or a file of positions",
                            "check the path"});
    return read_hand_path(script);
}

}  // namespace palpate
