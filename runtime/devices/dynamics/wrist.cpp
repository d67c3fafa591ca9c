// SPDX-License-Identifier: Apache-2.0
#include "runtime/devices/dynamics/wrist.hpp"

#include <utility>

#include "formats/model/geometry/rotations.hpp"

namespace palpate::devices {
namespace {

using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double nmm_s2_per_kg_mm2 = 1e-3;

}  // namespace

Wrist::Wrist(const DeviceModel& model, const HandImpedance& hand, const Quaterniond& orientation, bool held,
             double step_s)
    : step_s_(step_s),
      damping_(model.torsional_damping),
      held_motion_(nmm_s2_per_kg_mm2 * model.inertia_kg_mm2, model.torsional_damping + hand.torsional_damping,
                   hand.torsional_stiffness, step_s),
      free_motion_(nmm_s2_per_kg_mm2 * model.inertia_kg_mm2, model.torsional_damping, 0, step_s),
      held_(held),
      hand_orientation_(orientation),
      orientation_(orientation) {}

// How the hand holds the tool at the end of a step; hand_orientation_ is how it does at the beginning.
Quaterniond Wrist::grip(const Quaterniond& wish, bool holds) noexcept {
    const bool held_before = std::exchange(held_, holds);
    if (!held_ || !held_before) {
        hand_orientation_ = orientation_;
        slack_ = rotation_between(wish, orientation_);
        return orientation_;
    }
    const double angle = slack_.norm(), less = take_up_rate * step_s_;
    slack_ = angle > less ? Vector3d(slack_ * (1 - less / angle)) : Vector3d(Vector3d::Zero());
    return turned(wish, slack_);
}

void Wrist::step(const Quaterniond& wish, bool holds, const Vector3d& torque) noexcept {
    const Quaterniond hand_end = grip(wish, holds);
    const Quaterniond hand_begin = std::exchange(hand_orientation_, hand_end);
    const Vector3d hand_velocity = rotation_between(hand_begin, hand_end) / step_s_;
    // Seen from the hand, which turns uniformly, the equation has constant coefficients.
    const Vector3d offset = rotation_between(hand_begin, orientation_);
    const Vector3d slip = angular_velocity_ - hand_velocity, driving = torque - damping_ * hand_velocity;
    const HeldMotion& motion = held_ ? held_motion_ : free_motion_;
    orientation_ = turned(hand_end, motion.offset(offset, slip, driving));
    angular_velocity_ = hand_velocity + motion.velocity(offset, slip, driving);
}

}  // namespace palpate::devices
