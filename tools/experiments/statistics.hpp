// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

namespace palpate::experiments {

/// A share of trials and what is known of the chance behind it.
struct Interval {
    double lower = 0, upper = 1;
};

/// The interval of Clopper and Pearson (1934), 95 %, for `count` out of `trials` >= 1: chances at which the
/// tail from the count on, or up to it, is 2.5 %. To 1e-9, by bisection of the binomial sum.
Interval chance_interval(int count, int trials);

/// The value below which `fraction` of the values lie, by linear interpolation; NaN if there are none.
double quantile(std::vector<double> values, double fraction);
double mean(const std::vector<double>& values);  ///< NaN if there are none

}  // namespace palpate::experiments
