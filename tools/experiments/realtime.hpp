// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/experiments/experiments.hpp"

namespace palpate::experiments {

/// Runs the servo loop against the clock with four busy processes beside it, with and without real-time
/// priority: what a tick takes, how late it wakes, what it misses, and whether the record is whole.
Findings realtime(const Options& options, cli::Session& session);

}  // namespace palpate::experiments
