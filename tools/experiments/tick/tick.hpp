// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/experiments/experiments.hpp"

namespace palpate::experiments {

/// Times HapticModel::tick() by scheme, tool, friction, body and number of contacts, alone and with every
/// core busy; `--surface` and `--path` add the rigid bone, `--case` assets.
Findings tick(const Options& options, cli::Session& session);

}  // namespace palpate::experiments
