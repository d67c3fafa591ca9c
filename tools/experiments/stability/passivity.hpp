// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/experiments/experiments.hpp"

namespace palpate::experiments {

/// Finds the stiffest virtual wall that the simulated device bears, over damping, mass and refresh rate,
/// against 2 b / T and the eigenvalues of the sampled loop; then what friction, encoders, delay and a hand
/// change, and the same wall through HapticModel.
Findings passivity(const Options& options, cli::Session& session);

}  // namespace palpate::experiments
