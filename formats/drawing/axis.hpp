// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

namespace palpate::drawing {

/// Where values lie between the ends of an axis, and which of them get a tick.
struct Axis {
    bool log = false;
    double begin = 0, end = 1;    ///< of the value, or of its decadic logarithm
    std::vector<double> ticks{};  ///< values

    /// 0 at the axis's begin, 1 at its end.
    double place(double value) const;
};

/// Whether the value has a place on some axis: finite, and positive if it is logarithmic.
bool is_drawable(double value, bool log);

/// From `low` to `high`, both drawable. Linear: at most `count` steps of 1, 2 or 5 times a power of ten, from
/// 0 unless the values are far from it. Logarithmic: whole decades; where there are but two, 2 and 5 times
/// each have a tick as well.
Axis axis_between(double low, double high, bool log, double count);

}  // namespace palpate::drawing
