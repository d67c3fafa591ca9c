// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>

#include "runtime/haptics/tool_pose.hpp"

namespace palpate::haptics {

/// A point of a tool's surface at a body.
struct ToolTouch {
    std::int32_t point = 0;  ///< of the shell, or the triangle that it lies on
    std::int32_t body = 0;
    double distance = 0;  ///< mm, below zero inside
    Twist slope =
        Twist::Zero();  ///< of the distance by the tool's motion: its gradient g, then r x g, per mm and rad
    double press = 0;   ///< N, with which it holds the tool off along the gradient's direction
    Eigen::Vector3d arm = Eigen::Vector3d::Zero();  ///< r, from the tool's origin to the point, mm, frame P

    Eigen::Vector3d gradient() const noexcept { return slope.head<3>(); }
};

}  // namespace palpate::haptics
