// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "formats/drawing/chart.hpp"
#include "tools/experiments/puncture/approach_run.hpp"

namespace palpate::experiments {

/// What the publication does not state: how thick the wall is (mm), and how stiffly the hand presses (N/mm).
inline constexpr std::array walls{1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0};
inline constexpr std::array hands{0.1, 0.3, 0.5, 1.0, 2.0, 3.0};

/// The two readings of a published scheme: the face in contact kept, and renewed by every detection.
struct Reading {
    std::string_view name, single, twice;  ///< for tables; the schemes
};
inline constexpr std::array readings{Reading{"face kept", "single", "twice"},
                                     Reading{"face renewed", "single-renewed", "twice-renewed"}};

/// Punctures in 100 approaches, for each hand the walls from thin to thick.
using WallCounts = std::array<std::array<int, walls.size()>, hands.size()>;

struct WallMap {
    struct Counts {
        WallCounts single{}, twice{};
    };
    std::array<Counts, readings.size()> of_reading;
    double coupling = 0;  ///< N/mm
};

/// Counts punctures in 100 approaches, at the published speed, onto plates of one thickness each; the
/// detection loop's phases are spread evenly.
int punctures_of_wall(std::string_view scheme, const devices::DeviceModel& device, double wall,
                      double hand_stiffness);
WallMap map_walls(const devices::DeviceModel& device);

/// The thickest wall (mm) up to which `counts`, walls from thin to thick, exceed `count`, by linear
/// interpolation; NaN if the thickest does too.
double wall_at(const std::array<int, walls.size()>& counts, double count);

/// Appends the counts, and where the published 14 and 4 in 100 lie among them. Returns the figures.
nlohmann::ordered_json add_wall_tables(std::string& table, const WallMap& map);
/// Where they lie, a chart for each reading.
std::vector<drawing::Chart> wall_charts(const WallMap& map);

}  // namespace palpate::experiments
