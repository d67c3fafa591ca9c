// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <optional>

namespace palpate {

/// The arm of a Phantom: a parallelogram on a turret.
struct PhantomArm {
    double upper = 0;        ///< L1, mm, from the turret's axis to the elbow
    double fore = 0;         ///< L2, mm, from the elbow to the tip
    Eigen::Vector3d offset;  ///< p_D of the tip with all joints at zero, mm
};

/// The Touch's (Omni's), as its published configuration states it.
inline const PhantomArm touch_arm{133.35, 133.35, {0, -110, -35}};

/// Computes where the tip is, p_D in mm, from the joint angles (t1, t2, t3) in rad, both links measured from
/// the turret:
///     x = -sin t1 (L1 cos t2 + L2 sin t3) + o_x
///     y = L1 sin t2 - L2 cos t3 + L2 + o_y
///     z = cos t1 (L1 cos t2 + L2 sin t3) - L1 + o_z
/// The sign of x is from the same formula and was not checked by a recorded pose. Realtime-safe.
Eigen::Vector3d tip_of(const PhantomArm& arm, const Eigen::Vector3d& joints) noexcept;

/// Computes the joint angles (rad) that bring the tip to `tip` (p_D, mm), with the elbow above the line from
/// turret to tip and the arm before the turret: |t1| <= pi, the elbow opens by 0 to pi. Nothing where the
/// links do not reach, or on the turret's axis, where t1 is any angle. Realtime-safe.
std::optional<Eigen::Vector3d> joints_of(const PhantomArm& arm, const Eigen::Vector3d& tip) noexcept;

}  // namespace palpate
