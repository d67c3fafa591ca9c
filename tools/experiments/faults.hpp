// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/experiments/experiments.hpp"

namespace palpate::experiments {

/// Pushes on the cases for a virtual day while faults happen at random: whether every force keeps to the
/// limits, goes when it must, comes back gently, and every fault is reported once.
Findings faults(const Options& options, cli::Session& session);

}  // namespace palpate::experiments
