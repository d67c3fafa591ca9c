// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "tests/benchmarks/condensation/measure.hpp"

namespace palpate {

/// What measurements say about one limit.
struct Figure {
    std::string name;
    double value = 0;
    std::string limit;        ///< "<= 1.6"; empty if none is meant for a surface of this size
    std::optional<bool> met;  ///< none without a limit
};

/// Compares the measurements of one body, made in one run, with the limits. Of repeated measurements the
/// fastest counts; figures whose measurements are absent are left out.
std::vector<Figure> figures_of(const std::vector<Json>& measurements);

/// Prints the seconds of each method and each figure with its limit and whether it is met.
void print_figures(std::FILE* file, const std::vector<Json>& measurements,
                   const std::vector<Figure>& figures);

}  // namespace palpate
