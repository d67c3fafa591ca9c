// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdio>
#include <vector>

#include "tests/benchmarks/condensation/measure.hpp"

namespace palpate {

/// Prints what the measurements of one body, in one run, say about the limits: a ratio or residual a line,
/// with its limit and whether it is met. Of repeated measurements the fastest counts. Figures whose
/// measurements are absent are left out.
void print_figures(std::FILE* file, const std::vector<Json>& measurements);

}  // namespace palpate
