// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>

namespace palpate::visual {

/// What the timeline shows of a recording.
struct TimelineView {
    std::vector<Eigen::Vector2d> forces;  ///< least and largest of each of its columns, N
    double share = 0;                     ///< where the head is, 0 ... 1
    std::string text{};                   ///< time and speed
};

}  // namespace palpate::visual
