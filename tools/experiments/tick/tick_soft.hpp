// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "formats/model/body.hpp"
#include "tools/cli/command.hpp"
#include "tools/experiments/tick/tick_runs.hpp"

namespace palpate::experiments {

/// A soft body and a tool of the size that loads about `loaded` of its nodes.
struct SoftTouchCase {
    Case patient_case;
    int loaded = 0;
    devices::HandPath path;
};

/// Ticks that touch soft ellipsoids of about 500, 1000 and 2000 contact nodes with tools of several sizes.
struct SoftTicks {
    std::vector<TickRow> rows;
    struct Point {
        std::size_t nodes;
        double loaded, p50, p999;  ///< us
    };
    std::vector<Point> without_friction;
    SoftTouchCase loaded;  ///< that of the rows under load: 2000 nodes, 16 of them loaded
};
SoftTicks soft_ticks(cli::Session& session);

/// Ticks that touch the first deformable body of an asset as `palpate touch` does.
TickRow case_ticks(const Case& patient_case);

}  // namespace palpate::experiments
