// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>

#include "runtime/haptics/shell/tool_touch.hpp"

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

/// The energy of a tool after a small motion, where distances change in proportion to it:
///     E = 1/2 k |x - x_d|^2 + 1/2 kappa |theta|^2 + sum_i 1/2 K min(d_i, 0)^2,
/// x its position, theta the rotation vector from the device's orientation to its own: convex, quadratic by
/// pieces. Realtime-safe.
class RestingModel {
  public:
    /// About `pose`; `touches` have d_i and its slope, and must outlive this. `contact_stiffness`: K, N/mm.
    /// `longest_arm`: of the tool's points, mm.
    RestingModel(const TurningCoupling& coupling, const ToolPose& pose, double contact_stiffness,
                 std::span<const ToolTouch> touches, double longest_arm) noexcept;

    /// The motion of least energy, piece by piece downhill.
    Twist least() const noexcept;

  private:
    double part_downhill(const Twist& motion, const Twist& way) const noexcept;
    Twist least_of_piece(const Twist& motion) const noexcept;

    Twist spring_, pulled_;
    double contact_stiffness_, longest_arm_;
    std::span<const ToolTouch> touches_;
};

}  // namespace palpate::haptics
