// SPDX-License-Identifier: Apache-2.0
#include "runtime/devices/dynamic_device.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <unsupported/Eigen/MatrixFunctions>
#include <utility>

#include "formats/model/errors.hpp"
#include "runtime/devices/set_orientation.hpp"

namespace palpate::devices {
namespace {

using Eigen::Vector3d;

// The exact solution over one step for an offset x with m x'' + c x' + k x = F (mm, N, s; m in N s²/mm).
Eigen::Matrix<double, 2, 3> transition_of(double mass, double damping, double stiffness) {
    Eigen::Matrix3d rates;
    rates << 0, 1, 0,                                  //
        -stiffness / mass, -damping / mass, 1 / mass,  //
        0, 0, 0;
    const Eigen::Matrix3d exact = (rates * DynamicDevice::step_s).exp();
    return exact.topRows<2>();
}

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
    require(std::isfinite(model.thermal_time_s) && model.thermal_time_s > 0, "thermal_time_s",
            model.thermal_time_s, "more than 0");
    not_negative(hand.stiffness, "the hand's stiffness");
    not_negative(hand.damping, "the hand's damping");
}

}  // namespace

DynamicDevice::DynamicDevice(DeviceModel model, HandImpedance impedance, std::shared_ptr<Hand> hand,
                             const std::array<double, 3>& shaft)
    : model_(std::move(model)), impedance_(impedance), hand_(std::move(hand)), shaft_(shaft) {
    check(model_, impedance_);
    assert(hand_ != nullptr);
    const HandWish wish = hand_->at(0);
    held_ = wish.holds;
    orientation_ = wish.orientation;
    jaw_angle_ = wish.jaw_angle;
    hand_position_ = position_ = wish.position;
    const double mass = 1e-3 * model_.mass_kg;  // N s²/mm
    held_transition_ = transition_of(mass, model_.damping + impedance_.damping, impedance_.stiffness);
    free_transition_ = transition_of(mass, model_.damping, 0);
    cooling_ = std::exp(-step_s / model_.thermal_time_s);
    commands_.assign(static_cast<std::size_t>(model_.delay_ticks) + 1, Vector3d::Zero());
}

DynamicDevice::DynamicDevice(DeviceModel model, HandImpedance impedance, HandPath path,
                             const std::array<double, 3>& shaft)
    : DynamicDevice(std::move(model), impedance, std::make_shared<ScriptedHand>(std::move(path)), shaft) {}

realtime::DeviceState DynamicDevice::read(double time) noexcept {
    const std::int64_t last = std::llround(time / step_s);
    while (steps_ < last) {
        const HandWish wish = hand_->at(static_cast<double>(++steps_) * step_s);
        orientation_ = wish.orientation;
        jaw_angle_ = wish.jaw_angle;
        step(wish);
        warm_up();
    }

    realtime::DeviceState state;
    state.shaft = shaft_;
    set_orientation(state, orientation_);
    state.jaw_angle = jaw_angle_;
    state.time = time;
    state.faults = warm_ ? motors_warm : no_fault;
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

void DynamicDevice::step(const HandWish& wish) noexcept {
    const Vector3d hand_end = grip(wish);
    const Vector3d hand_begin = std::exchange(hand_position_, hand_end);
    const Vector3d hand_velocity = (hand_end - hand_begin) / step_s;
    const HandImpedance hand = held_ ? impedance_ : HandImpedance{.stiffness = 0, .damping = 0};
    const Transition& transition = held_ ? held_transition_ : free_transition_;

    Vector3d driving = force_;
    const bool rests = velocity_.isZero(0);
    if (const double friction = model_.coulomb_friction; friction > 0) {
        const Vector3d pull =
            force_ + hand.stiffness * (hand_begin - position_) + hand.damping * hand_velocity;
        if (rests && pull.norm() <= friction) return;
        driving -= friction * (rests ? pull : velocity_).normalized();
    }
    // Seen from the hand, which moves uniformly, the equation is linear with constant coefficients.
    const Vector3d offset = position_ - hand_begin, slip = velocity_ - hand_velocity;
    driving -= model_.damping * hand_velocity;
    const auto after = [&](Eigen::Index row) -> Vector3d {
        return transition(row, 0) * offset + transition(row, 1) * slip + transition(row, 2) * driving;
    };
    const Vector3d velocity = hand_velocity + after(1);
    const double turn = velocity.dot(velocity_);
    if (model_.coulomb_friction > 0 && !rests && turn <= 0) {
        // Friction turns no motion round: it ends on the way, after about this part of the step.
        const double part = 1 / (1 - turn / velocity_.squaredNorm());
        position_ += 0.5 * part * step_s * velocity_;
        velocity_.setZero();
        return;
    }
    position_ = hand_end + after(0);
    velocity_ = velocity;
}

void DynamicDevice::warm_up() noexcept {
    temperature_ = heating_ + cooling_ * (temperature_ - heating_);
    if (temperature_ >= 1) warm_ = true;
    if (temperature_ <= cool_enough) warm_ = false;
}

void DynamicDevice::write(const std::array<double, 3>& force) noexcept {
    assert(std::ranges::all_of(force, [](double f) { return std::isfinite(f); }));
    const Eigen::Map<const Vector3d> wanted(force.data());
    const double length = wanted.norm();
    commands_[next_command_] =
        length > model_.max_force ? wanted * (model_.max_force / length) : Vector3d(wanted);
    next_command_ = (next_command_ + 1) % commands_.size();
    force_ = commands_[next_command_];
    const double lasting = model_.max_continuous_force;
    heating_ = lasting > 0 ? force_.squaredNorm() / (lasting * lasting) : 0;
}

}  // namespace palpate::devices
