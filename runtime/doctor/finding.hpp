// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

namespace palpate::doctor {

enum class Level {
    ok,       ///< as it should be, or only worth knowing
    warning,  ///< works, but less well
    problem   ///< does not work
};

/// What a check of this machine found.
struct Finding {
    std::string id;     ///< unique in a report: "fifo"
    std::string group;  ///< "real time"
    Level level = Level::ok;
    std::string found;  ///< one line
    /// Shell lines to paste; a line of advice begins with '#'. Empty where nothing is to be done.
    std::string fix;
};

using Findings = std::vector<Finding>;

/// What the machine is to run.
enum class Purpose { device, simulation };

/// How bad the lack of something is that a device needs and a simulation can do without.
inline Level lack_of(Purpose purpose) {
    return purpose == Purpose::device ? Level::problem : Level::warning;
}

/// "ok", "warning" or "problem".
const char* name_of(Level level);

/// How many of the findings are of a level.
std::size_t count(const Findings& findings, Level level);

}  // namespace palpate::doctor
