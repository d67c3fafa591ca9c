// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "runtime/haptics/tool_pose.hpp"

namespace palpate::haptics {

/// The spring between a device and the tool that it leads.
struct TurningCoupling {
    ToolPose device;
    double stiffness = 0;            ///< k, N/mm
    double torsional_stiffness = 0;  ///< kappa, N mm/rad
};

/// How the search for rest ended.
enum class ToolRest {
    settled,
    on_its_way,  ///< the device is farther than the tool goes in one tick
    unsettled,   ///< it moved to and fro
};

/// A search ends with steps that move no point of the tool farther, mm: less moves no force that a hand
/// feels.
inline constexpr double settled_step = 1e-5;
/// A search that ends with steps beyond is told of, mm.
inline constexpr double tolerated_step = 1e-3;

}  // namespace palpate::haptics
