// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "tools/experiments/experiments.hpp"

namespace palpate::experiments {

/// Force before and after the published improvement, and with ours: curves and numbers of one hand that
/// presses, slides and leaves; then a long run of random pushing, sliding and leaving with ours.
Findings stability(const Options& options, cli::Session& session);

}  // namespace palpate::experiments
