// SPDX-License-Identifier: Apache-2.0
#include "formats/drawing/axis.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::drawing {
namespace {

Axis log_axis(double low, double high) {
    Axis axis{.log = true, .begin = std::floor(std::log10(low)), .end = std::ceil(std::log10(high))};
    if (axis.begin == axis.end) ++axis.end;
    const double stride = std::ceil((axis.end - axis.begin) / 8);
    for (double decade = axis.begin; decade <= axis.end; decade += stride)
        for (const double factor : {1.0, 2.0, 5.0})
            if (factor == 1 || (axis.end - axis.begin <= 2 && decade < axis.end))
                axis.ticks.push_back(factor * std::pow(10, decade));
    return axis;
}

Axis linear_axis(double low, double high, double count) {
    if (low > 0 && low < 0.5 * high) low = 0;
    if (high < 0 && high > 0.5 * low) high = 0;
    if (!(high > low)) high = low + std::max(1.0, std::abs(low));
    const double power = std::pow(10, std::floor(std::log10((high - low) / count)));
    double step = 10 * power;
    for (const double factor : {5.0, 2.0, 1.0})
        if ((high - low) / (factor * power) <= count) step = factor * power;
    const double first = std::floor(low / step + 1e-9), last = std::ceil(high / step - 1e-9);
    Axis axis{.log = false, .begin = first * step, .end = last * step};
    for (double k = first; k <= last; ++k) axis.ticks.push_back(k * step);
    return axis;
}

}  // namespace

double Axis::place(double value) const {
    return ((log ? std::log10(value) : value) - begin) / (end - begin);
}

bool is_drawable(double value, bool log) {
    return std::isfinite(value) && (!log || value > 0);
}

Axis axis_between(double low, double high, bool log, double count) {
    return log ? log_axis(low, high) : linear_axis(low, high, count);
}

}  // namespace palpate::drawing
