// SPDX-License-Identifier: Apache-2.0
#include "runtime/session/hand_script.hpp"

#include <algorithm>
#include <array>
#include <filesystem>
#include <string_view>

#include "formats/model/errors.hpp"
#include "runtime/devices/jaws/grasp_script.hpp"

namespace palpate::session {
namespace {

using namespace devices;

constexpr std::array<std::string_view, 6> scripts{"press",  "slide",  "tremble",
                                                  "let-go", "random", grasp_script};

// A script may have been mistyped.
void require_file(const std::string& script, bool of_forceps) {
    if (!std::filesystem::exists(script))
        throw InvalidInput({script, "no such script or file",
                            of_forceps ? "grasp or a file of poses and jaw angles"
                                       : "press, slide, tremble, let-go, random or a file of positions",
                            "check the path"});
}

}  // namespace

bool is_made_to_measure(const std::string& script) {
    return std::ranges::find(scripts, script) != scripts.end();
}

HandPath made_to_measure_path(const std::string& script, const TouchPoint& place,
                              const ScriptSettings& settings, std::uint64_t seed) {
    if (script == "press") return press_path(place, settings);
    if (script == "slide") return slide_path(place, settings);
    if (script == "tremble") return tremble_path(place, settings, seed);
    if (script == "let-go") return let_go_path(place, settings);
    return random_path(place, settings, seed);
}

HandPath recorded_path(const std::string& script, bool of_forceps) {
    require_file(script, of_forceps);
    HandPath path = read_hand_path(script);
    const bool has_angles = path.keys().front().jaw_angle >= 0;
    if (of_forceps && !has_angles)
        throw InvalidInput(
            {script, "no jaw angles", "rows of t x y z qx qy qz qw and an angle", "or leave --script out"});
    if (has_angles && !of_forceps)
        throw InvalidInput(
            {script, "jaw angles where no forceps is held", "--instrument forceps beside it", ""});
    return path;
}

HandPath recorded_axis_path(const std::string& script, std::size_t column, const TouchPoint& place,
                            const ScriptSettings& settings) {
    if (is_made_to_measure(script))
        throw UsageError({"--column", "with --script " + script, "a file of a recorded axis", ""});
    require_file(script, false);
    return recorded_axis_path(place, settings, read_column(script, column));
}

}  // namespace palpate::session
