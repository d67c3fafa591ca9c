// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "runtime/haptics/solid/solid_watch.hpp"
#include "runtime/haptics/whole_tool/tool_rest.hpp"

namespace palpate::haptics {

/// Moves a tool without mass from `pose` to where it rests between its device and the surfaces of the bodies,
/// which it never meets: the least of the springs' energy with all touches at least SolidWatch::margin apart.
/// In rounds, each to the least where distances of close features change in proportion to the motion
/// (nearest_motion()), as much of the way as is safe (SolidWatch::safe_part()). At `pose` the tool is clear.
/// Leaves in `watch` what is close to the pose, and what it presses with. Realtime-safe; costs some 0.1 ms a
/// round. Source: the god-object of Ortega, Redon, Coquillart 2007, "A six degree-of-freedom god-object
/// method for haptic display of rigid bodies with surface properties", which moves by accelerations and takes
/// milliseconds; here the tool is at rest in every tick.
ToolRest bring_to_rest(SolidWatch& watch, const TurningCoupling& coupling, ToolPose& pose) noexcept;

}  // namespace palpate::haptics
