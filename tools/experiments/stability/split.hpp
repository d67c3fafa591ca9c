// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/experiments/experiments.hpp"

namespace palpate::experiments {

/// Presses ellipsoids of soft tissue, 1 : 1 to 1 : 100 in stiffness, into each other by 0.5 to 4 mm, and
/// compares the published split by force ratio with the exact solution: balance of forces, elastic energy,
/// and how deep the deformed surfaces still are in each other.
Findings split(const Options& options, cli::Session& session);

}  // namespace palpate::experiments
