// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/experiments/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace palpate::experiments {
namespace {

// Chance of at most `count` successes.
double binomial_tail(int count, int trials, double chance) {
    double sum = 0;
    for (int k = 0; k <= count; ++k)
        sum += std::exp(std::lgamma(trials + 1) - std::lgamma(k + 1) - std::lgamma(trials - k + 1) +
                        k * std::log(chance) + (trials - k) * std::log1p(-chance));
    return sum;
}

// The chance at which the falling tail up to `count` is `level`.
double chance_at(int count, int trials, double level) {
    double low = 0, high = 1;
    while (high - low > 1e-9) {
        const double middle = (low + high) / 2;
        (binomial_tail(count, trials, middle) > level ? low : high) = middle;
    }
    return (low + high) / 2;
}

}  // namespace

Interval chance_interval(int count, int trials) {
    return {count == 0 ? 0 : chance_at(count - 1, trials, 0.975),
            count == trials ? 1 : chance_at(count, trials, 0.025)};
}

double quantile(std::vector<double> values, double fraction) {
    if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
    std::ranges::sort(values);
    const double place = fraction * static_cast<double>(values.size() - 1);
    const auto below = static_cast<std::size_t>(place);
    const std::size_t above = std::min(below + 1, values.size() - 1);
    return std::lerp(values[below], values[above], place - static_cast<double>(below));
}

double mean(const std::vector<double>& values) {
    return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

}  // namespace palpate::experiments
