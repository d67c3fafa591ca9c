// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/experiments/experiments.hpp"

namespace palpate::experiments {

/// Whole tools on a bone with `continuous`, `shell`, `cones`, `features` and `solid`: what a tick takes, how
/// deep the tool goes by exact distances and by Bullet, whether it meets the bone by FCL, how far it drifts
/// while the hand rests, and what comes of fast approaches.
Findings sixdof(const Options& options, cli::Session& session);

}  // namespace palpate::experiments
