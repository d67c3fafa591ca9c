// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "runtime/haptics/whole_tool/tool_rest.hpp"
#include "runtime/haptics/whole_tool/tool_touch.hpp"

namespace palpate::haptics {

/// A motion, and whether it keeps all touches: where they contradict each other it keeps them as they are.
struct NearestMotion {
    Twist motion;
    bool keeps_all;
};

/// Finds the motion x that brings a tool nearest to where its springs want it and keeps all touches:
///     the least of E = 1/2 k |x - x_d|^2 + 1/2 kappa |theta|^2   subject to   d_i + slope_i . x >= 0,
/// x_d and theta from the pose to the device's, d_i a touch's distance; a touch that is kept presses with its
/// multiplier (N), which is written to it. Exact: a least-distance problem, by non-negative least squares of
/// as few touches as bear force, seven at most (Lawson, Hanson 1974, Solving least squares problems, chapter
/// 23). O(touches) for each that bears force; realtime-safe.
NearestMotion nearest_motion(const TurningCoupling& coupling, const ToolPose& pose,
                             std::span<ToolTouch> touches) noexcept;

}  // namespace palpate::haptics
