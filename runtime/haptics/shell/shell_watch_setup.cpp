// SPDX-License-Identifier: Apache-2.0
// What a watch over a shell allocates.
#include <algorithm>

#include "runtime/haptics/shell/shell_watch.hpp"

namespace palpate::haptics {

ShellWatch::ShellWatch(std::span<const collision::ShellPoint> points,
                       std::span<const collision::DistanceField> fields, double close)
    : points_(points), fields_(fields), close_(close) {
    watched_.reserve(points.size());
    for (const collision::ShellPoint& point : points) {
        watched_.push_back({point.position.cast<double>().norm(), 0});
        longest_arm_ = std::max(longest_arm_, watched_.back().arm);
    }
    near_.resize(points.size());
    found_.resize(points.size() * fields.size());
}

}  // namespace palpate::haptics
