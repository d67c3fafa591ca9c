// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <functional>

namespace palpate::fem {

/// Estimates the largest eigenvalue of a symmetric positive definite map of `size` unknowns to 1 % by
/// restarted Lanczos steps from a fixed start (Spectra: Sorensen 1992); `apply` replaces v by the map's
/// image. A Rayleigh quotient, so never above the true value but for rounding. Deterministic.
double largest_eigenvalue(Eigen::Index size, const std::function<void(Eigen::VectorXd&)>& apply);

}  // namespace palpate::fem
