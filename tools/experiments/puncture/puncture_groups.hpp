// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "tools/experiments/puncture/approach_run.hpp"

namespace palpate::experiments {

inline constexpr std::size_t puncture_groups = 10, approaches_per_group = 10;

/// The contact methods that are compared, and which of them holds the tool outside: the published ones, the
/// face in contact kept, then renewed, and ours.
inline constexpr std::array<std::string_view, 5> schemes{"single", "twice", "single-renewed", "twice-renewed",
                                                         "continuous"};
inline constexpr std::size_t continuous_scheme = 4;
/// "| what | single | twice | ... |" and the rule below, for tables with a column for each scheme.
std::string scheme_columns(const std::string& what);

/// The same approaches by every scheme, group after group.
struct GroupRun {
    std::vector<Approach> approaches;
    std::array<std::vector<Outcome>, schemes.size()> outcomes;
    double coupling = 0;  // N/mm
};

/// Appends the published tables 1 and 2 for every scheme, beside the published figures, and what is known of
/// the chances. Returns the figures.
nlohmann::ordered_json add_group_tables(std::string& table, const GroupRun& run);

/// Appends why approaches end in punctures, from what the run measured: thickness, delay, depth. Returns the
/// figures.
nlohmann::ordered_json add_reasons(std::string& table, const GroupRun& run);

/// "1.1 … 9.9 %", for tables.
std::string chance_text(int count, int trials);

}  // namespace palpate::experiments
