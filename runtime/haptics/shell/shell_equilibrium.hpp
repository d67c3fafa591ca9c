// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "runtime/haptics/shell/shell_watch.hpp"
#include "runtime/haptics/whole_tool/tool_rest.hpp"

namespace palpate::haptics {

/// Moves a tool without mass from `pose` downhill to where it rests between its device and the bodies that
/// the points of its shell are inside of, a minimum of
///     E = 1/2 k |x - x_d|^2 + 1/2 kappa |theta|^2 + sum_i 1/2 K d_i^2,
/// x its position, theta the rotation vector from the device's orientation to its own, d_i < 0 the field's
/// distance at point i; in rounds, each to the least of E where the distances of close points change in
/// proportion to the motion (Gauss-Newton, points that come in or go out among them), halved until E goes
/// down. The force on the device k (x - x_d) and the torque kappa theta are then gradients of the least
/// energy with respect to the device's motions. No step takes a point farther than `longest_step`. Leaves in
/// `watch` what is close to the pose. `contact_stiffness`: K, N/mm. `longest_step`: mm, no more than what
/// `watch` takes for close. Realtime-safe; costs some 100 ns a round and point near a body. Sources: Wan,
/// McNeely 2003, "Quasi-static approximation for 6 degrees-of-freedom haptic rendering" (a tool without
/// mass); McNeely, Puterbaugh, Troy 1999 (points against voxels); Barbic, James 2008 (forces along the
/// distance's gradient).
ToolRest bring_to_rest(ShellWatch& watch, const TurningCoupling& coupling, double contact_stiffness,
                       double longest_step, ToolPose& pose) noexcept;

}  // namespace palpate::haptics
