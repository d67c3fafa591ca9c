// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/experiments/experiments.hpp"

namespace palpate::experiments {

/// Looks for a puncture with `continuous`: pushes a tool at random places of every `--surface`,
/// `--approaches` times each (10 000 by default), the hand at 50 to 1000 mm/s. Takes session.threads. Throws
/// UsageError without a surface.
Findings many_approaches(const Options& options, cli::Session& session);

}  // namespace palpate::experiments
