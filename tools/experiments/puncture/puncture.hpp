// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/experiments/experiments.hpp"

namespace palpate::experiments {

/// Counts how often a tool is pushed through a bone (`--surface`) by each contact scheme, as the published
/// tables 1 and 2 do, says why, finds where their counts lie over wall and pressure, and draws figures 6
/// and 8 with and without the synchroniser. Throws UsageError without a surface, or with several.
Findings puncture(const Options& options, cli::Session& session);

}  // namespace palpate::experiments
