// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "tools/cli/command.hpp"

namespace palpate::experiments {

/// What an experiment may be told. Each reads what it needs.
struct Options {
    std::vector<std::filesystem::path> surfaces;  ///< triangles (.vtp), LPS mm
    std::vector<std::filesystem::path> cases;     ///< assets (.vtkhdf)
    std::vector<std::filesystem::path> tools;     ///< closed surfaces of instruments (.stl), tool's frame, mm
    std::filesystem::path path;                   ///< recorded hand path
    std::filesystem::path output = "bench";       ///< folder for the table (.md) and the pictures (.svg)
    std::uint64_t seed = 1;
    double seconds = 0;                ///< 0: the experiment's own
    std::int64_t approaches = 0;       ///< of each surface; 0: the experiment's own
    std::vector<std::string> schemes;  ///< ways to feel a tool; none: all of the experiment's
};

/// What an experiment found: `result` is its JSON, `table` GitHub Markdown, `pictures` SVG by name.
struct Findings {  // NOLINT(bugprone-exception-escape): to move its JSON throws nothing
    nlohmann::ordered_json result;
    std::string table;
    std::vector<std::pair<std::string, std::string>> pictures;
};

struct Experiment {
    std::string_view name, summary;
    Findings (*run)(const Options&, cli::Session&);
};

}  // namespace palpate::experiments
