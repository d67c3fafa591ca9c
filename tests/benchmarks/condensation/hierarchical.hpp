// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "formats/model/body.hpp"
#include "tests/benchmarks/condensation/measure.hpp"

namespace palpate {

/// Measures condense_hierarchically() to a relative error of 1e-3, as Method::measure does. Besides seconds
/// and peak: "bytes" of its values; "error", the worst relative error (root mean square over the surface) of
/// the displacements under 100 random loads on 32 neighbouring contact nodes each, against solves; "block_us"
/// and "displacements_ms", medians of the run-time queries for those nodes: C_cc, and the displacements of
/// the whole surface.
Json measure_hierarchical(const DeformableBody& body, int threads);

}  // namespace palpate
