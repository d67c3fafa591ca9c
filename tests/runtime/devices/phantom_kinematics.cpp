// SPDX-License-Identifier: Apache-2.0
#include "tests/runtime/devices/phantom_kinematics.hpp"

#include <cmath>
#include <numbers>

namespace palpate {

using Eigen::Vector3d;

Vector3d tip_of(const PhantomArm& arm, const Vector3d& joints) noexcept {
    const double reach = arm.upper * std::cos(joints[1]) + arm.fore * std::sin(joints[2]);
    const double height = arm.upper * std::sin(joints[1]) - arm.fore * std::cos(joints[2]);
    return arm.offset +
           Vector3d(-std::sin(joints[0]) * reach, height + arm.fore, std::cos(joints[0]) * reach - arm.upper);
}

std::optional<Vector3d> joints_of(const PhantomArm& arm, const Vector3d& tip) noexcept {
    const Vector3d p = tip - arm.offset;
    const double ahead = p.z() + arm.upper;
    const double reach = std::hypot(p.x(), ahead), height = p.y() - arm.fore;
    const double squared = reach * reach + height * height, distance = std::sqrt(squared);
    if (!(reach > 0) || distance > arm.upper + arm.fore || distance < std::abs(arm.upper - arm.fore))
        return std::nullopt;
    // The triangle of turret, elbow and tip, by the law of cosines.
    const double upper = arm.upper * arm.upper, fore = arm.fore * arm.fore;
    const double at_turret = std::acos((squared + upper - fore) / (2 * arm.upper * distance));
    const double at_tip = std::acos((squared + fore - upper) / (2 * arm.fore * distance));
    const double rise = std::atan2(height, reach);
    return Vector3d(std::atan2(-p.x(), ahead), rise + at_turret, rise - at_tip + std::numbers::pi / 2);
}

}  // namespace palpate
