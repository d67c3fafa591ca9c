// SPDX-License-Identifier: Apache-2.0
#include "runtime/devices/dynamics/dynamic_device.hpp"

#include <cassert>
#include <cmath>
#include <memory>
#include <string>
#include <utility>

#include "formats/model/arrays.hpp"
#include "formats/model/errors.hpp"
#include "runtime/devices/set_orientation.hpp"

namespace palpate::devices {
namespace {

using Eigen::Vector3d;

constexpr double n_s2_per_mm_kg = 1e-3;

void check(const DeviceModel& model, const HandImpedance& hand) {
    const auto require = [&](bool holds, const char* what, double found, const char* expected) {
        if (!holds)
            throw InvalidInput(
                {"device model " + model.name, what + (" is " + std::to_string(found)), expected, ""});
    };
    const auto not_negative = [&](double value, const char* what) {
        require(std::isfinite(value) && value >= 0, what, value, "0 or more");
    };
    require(std::isfinite(model.mass_kg) && model.mass_kg > 0, "mass_kg", model.mass_kg, "more than 0");
    require(model.max_force >= 0, "max_force", model.max_force, "0 or more");
    not_negative(model.damping, "damping");
    not_negative(model.coulomb_friction, "coulomb_friction");
    not_negative(model.encoder_resolution, "encoder_resolution");
    not_negative(model.delay_ticks, "delay_ticks");
    not_negative(model.max_continuous_force, "max_continuous_force");
    not_negative(model.max_torque, "max_torque");
    not_negative(model.max_continuous_torque, "max_continuous_torque");
    not_negative(model.torsional_damping, "torsional_damping");
    not_negative(model.inertia_kg_mm2, "inertia_kg_mm2");
    require(model.max_torque == 0 || model.inertia_kg_mm2 > 0, "inertia_kg_mm2", model.inertia_kg_mm2,
            "more than 0");
    require(std::isfinite(model.thermal_time_s) && model.thermal_time_s > 0, "thermal_time_s",
            model.thermal_time_s, "more than 0");
    not_negative(hand.stiffness, "the hand's stiffness");
    not_negative(hand.damping, "the hand's damping");
    not_negative(hand.torsional_stiffness, "the hand's torsional stiffness");
    not_negative(hand.torsional_damping, "the hand's torsional damping");
}

// Checks before anything is made of it.
const DeviceModel& checked(const DeviceModel& model, const HandImpedance& hand) {
    check(model, hand);
    return model;
}

// Shortens it to what motors give.
Vector3d within(const std::array<double, 3>& wanted, double most) noexcept {
    const Vector3d asked = vector_of(wanted);
    const double length = asked.norm();
    return length > most ? Vector3d(asked * (most / length)) : asked;
}

}  // namespace

DynamicDevice::DynamicDevice(DeviceModel model, HandImpedance impedance, std::shared_ptr<Hand> hand,
                             const std::array<double, 3>& shaft)
    : model_(checked(model, impedance)),
      impedance_(impedance),
      hand_(std::move(hand)),
      shaft_(shaft),
      held_motion_(n_s2_per_mm_kg * model_.mass_kg, model_.damping + impedance.damping, impedance.stiffness,
                   step_s),
      free_motion_(n_s2_per_mm_kg * model_.mass_kg, model_.damping, 0, step_s),
      motors_(model_.max_continuous_force, model_.thermal_time_s, step_s),
      gimbal_motors_(model_.max_continuous_torque, model_.thermal_time_s, step_s),
      commands_(static_cast<std::size_t>(model_.delay_ticks) + 1) {
    assert(hand_ != nullptr);
    const HandWish wish = hand_->at(0);
    held_ = wish.holds;
    orientation_ = wish.orientation;
    jaw_angle_ = wish.jaw_angle;
    hand_position_ = position_ = wish.position;
    if (model_.max_torque == 0) return;
    if (!is_known(orientation_) && vector_of(shaft).norm() > 0)
        orientation_ = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), vector_of(shaft));
    if (is_known(orientation_)) wrist_.emplace(model_, impedance_, orientation_, held_, step_s);
}

DynamicDevice::DynamicDevice(DeviceModel model, HandImpedance impedance, HandPath path,
                             const std::array<double, 3>& shaft)
    : DynamicDevice(std::move(model), impedance, std::make_shared<ScriptedHand>(std::move(path)), shaft) {}

realtime::DeviceState DynamicDevice::read(double time) noexcept {
    const std::int64_t last = std::llround(time / step_s);
    while (steps_ < last) {
        const HandWish wish = hand_->at(static_cast<double>(++steps_) * step_s);
        jaw_angle_ = wish.jaw_angle;
        turn(wish);
        step(wish);
        motors_.warm_up();
        gimbal_motors_.warm_up();
    }

    realtime::DeviceState state;
    state.shaft = shaft_;
    set_orientation(state, wrist_ ? wrist_->orientation() : orientation_);
    state.jaw_angle = jaw_angle_;
    state.time = time;
    state.faults = motors_.warm() || gimbal_motors_.warm() ? motors_warm : no_fault;
    Eigen::Map<Vector3d> reading(state.position.data());
    reading = position_;
    if (const double grain = model_.encoder_resolution; grain > 0)
        reading = (position_ / grain).array().floor() * grain;
    return state;
}

// Where the hand holds the tip at the end of a step; hand_position_ is where it does at the beginning.
Vector3d DynamicDevice::grip(const HandWish& wish) noexcept {
    const bool held_before = std::exchange(held_, wish.holds);
    if (!held_ || !held_before) {
        hand_position_ = position_;
        slack_ = position_ - wish.position;
        return position_;
    }
    const double length = slack_.norm(), shorter = take_up_speed * step_s;
    slack_ = length > shorter ? Vector3d(slack_ * (1 - shorter / length)) : Vector3d(Vector3d::Zero());
    return wish.position + slack_;
}

// A hand that does not say how it wishes the tool turned keeps it as it was.
void DynamicDevice::turn(const HandWish& wish) noexcept {
    if (is_known(wish.orientation) || !wrist_) orientation_ = wish.orientation;
    if (wrist_) wrist_->step(orientation_, wish.holds, command_.torque);
}

void DynamicDevice::step(const HandWish& wish) noexcept {
    const Vector3d hand_end = grip(wish);
    const Vector3d hand_begin = std::exchange(hand_position_, hand_end);
    const Vector3d hand_velocity = (hand_end - hand_begin) / step_s;
    const HandImpedance hand = held_ ? impedance_ : HandImpedance{.stiffness = 0, .damping = 0};
    const HeldMotion& motion = held_ ? held_motion_ : free_motion_;

    Vector3d driving = command_.force;
    const bool rests = velocity_.isZero(0);
    if (const double friction = model_.coulomb_friction; friction > 0) {
        const Vector3d pull =
            command_.force + hand.stiffness * (hand_begin - position_) + hand.damping * hand_velocity;
        if (rests && pull.norm() <= friction) return;
        driving -= friction * (rests ? pull : velocity_).normalized();
    }
    // Seen from the hand, which moves uniformly, the equation is linear with constant coefficients.
    const Vector3d offset = position_ - hand_begin, slip = velocity_ - hand_velocity;
    driving -= model_.damping * hand_velocity;
    const Vector3d velocity = hand_velocity + motion.velocity(offset, slip, driving);
    const double turn = velocity.dot(velocity_);
    if (model_.coulomb_friction > 0 && !rests && turn <= 0) {
        // Friction turns no motion round: it ends on the way, after about this part of the step.
        const double part = 1 / (1 - turn / velocity_.squaredNorm());
        position_ += 0.5 * part * step_s * velocity_;
        velocity_.setZero();
        return;
    }
    position_ = hand_end + motion.offset(offset, slip, driving);
    velocity_ = velocity;
}

void DynamicDevice::write(const realtime::Wrench& wrench) noexcept {
    assert(vector_of(wrench.force).allFinite() && vector_of(wrench.torque).allFinite());
    commands_[next_command_] = {within(wrench.force, model_.max_force),
                                within(wrench.torque, model_.max_torque)};
    next_command_ = (next_command_ + 1) % commands_.size();
    command_ = commands_[next_command_];
    motors_.push(command_.force.norm());
    gimbal_motors_.push(command_.torque.norm());
}

}  // namespace palpate::devices
