// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "tools/report/quality.hpp"

namespace palpate::report {

/// One stage of a build.
struct StageRecord {
    std::string stage;                   ///< e.g. "mesh wall"
    double seconds = 0;                  ///< wall time
    std::int64_t peak_memory_bytes = 0;  ///< largest resident set
    std::string status;                  ///< "run" or "up to date"
};

/// Draws a histogram as inline SVG; `unit` follows the numbers on the axis, which has `steps` of them and 0.
std::string histogram_svg(const BinCounts& histogram, const std::string& axis, const std::string& unit,
                          int steps);

/// Draws one bar per stage as inline SVG: length is time, the text beside it time and peak memory.
std::string stages_svg(const std::vector<StageRecord>& stages);

}  // namespace palpate::report
