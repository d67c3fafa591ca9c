// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "formats/model/body.hpp"
#include "tests/benchmarks/condensation/measure.hpp"

namespace palpate {

/// One way to the compliance of a body's contact nodes, or a yardstick for it.
struct Method {
    std::string name;
    bool repeatable = false;  ///< short enough to be measured several times, beside its yardstick
    /// Bytes that it needs for so many unknowns of the surface, to know before starting; may be rough.
    std::function<double(double surface_dofs)> memory;
    /// Measures it, to be called in a child process of its own. Returns "seconds", "cpu_seconds",
    /// "peak_bytes", and what else is known of it.
    std::function<Json(const DeformableBody& body, int threads)> measure;
};

/// All that are measured, in order:
/// - exact: the faster of the next two by plan_condensation(), which is timed apart ("planning_seconds",
///   "chosen", "forecast_seconds", "forecast_bytes").
/// - trailing: condense_by_trailing_block(), then certify() for the residuals, untimed; "stages" are seconds
///   between its reports of progress, "bytes" what an asset stores.
/// - solves: condense_by_solves(), the same.
/// - lapack: dpotrf and dpotri on a dense matrix of as many unknowns as the surface has.
/// - cholmod: K factorised in CHOLMOD's own order, and solved for every surface unknown in panels of 256;
///   panels beyond a minute are not solved but counted ("solved_columns").
/// - iterative: conjugate gradients for every free unknown of all nodes, timed on a sample, with what SOFA's
///   PrecomputedConstraintCorrection sets: no preconditioner, |r| <= 1e-20 |b|, at most 5000 iterations.
/// - iterative_loose: the same as somebody in a hurry would run it: diagonal preconditioner, |r| <= 1e-6 |b|.
/// - hierarchical: measure_hierarchical().
const std::vector<Method>& condensation_methods();

}  // namespace palpate
