// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

#include "tools/case_builder/stage_runner.hpp"

namespace palpate::case_builder {

/// Forecasts the largest resident set of a stage, bytes, from the size of what it reads: files for an import,
/// voxels for stages on images, nodes for condensation. `runner` knows what the stages before it told. The
/// demo's cases and the cohort of tests/benchmarks/cohort.py take a tenth to nine tenths of it; an import
/// knows its files' bytes alone, and a label map that compresses more than a hundredfold may take more.
std::int64_t peak_memory_forecast(const Stage& stage, const StageRunner& runner);

}  // namespace palpate::case_builder
