// SPDX-License-Identifier: Apache-2.0
#include "runtime/devices/dynamic_device.hpp"

#include <cmath>
#include <unsupported/Eigen/MatrixFunctions>

#include "formats/model/errors.hpp"

namespace palpate {
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
    not_negative(hand.stiffness, "the hand's stiffness");
    not_negative(hand.damping, "the hand's damping");
}

}  // namespace

DynamicDevice::DynamicDevice(DeviceModel model, HandImpedance hand, HandPath path,
                             const std::array<double, 3>& shaft)
    : model_(std::move(model)),
      hand_(hand),
      path_(std::move(path)),
      shaft_(shaft),
      hand_position_(path_.at(0)),
      position_(hand_position_) {
    check(model_, hand_);
    const double mass = 1e-3 * model_.mass_kg;  // N s²/mm
    transition_ = transition_of(mass, model_.damping + hand_.damping, hand_.stiffness);
    commands_.assign(static_cast<std::size_t>(model_.delay_ticks) + 1, Vector3d::Zero());
}

DeviceState DynamicDevice::read(double time) noexcept {
    const std::int64_t last = std::llround(time / step_s);
    while (steps_ < last) step(path_.at(static_cast<double>(++steps_) * step_s));

    DeviceState state;
    state.shaft = shaft_;
    state.time = time;
    Eigen::Map<Vector3d> reading(state.position.data());
    reading = position_;
    if (const double grain = model_.encoder_resolution; grain > 0)
        reading = (position_ / grain).array().floor() * grain;
    return state;
}

void DynamicDevice::step(const Vector3d& hand_end) noexcept {
    const Vector3d hand_begin = hand_position_;
    const Vector3d hand_velocity = (hand_end - hand_begin) / step_s;
    hand_position_ = hand_end;

    Vector3d driving = force_;
    const bool rests = velocity_.isZero(0);
    if (const double friction = model_.coulomb_friction; friction > 0) {
        const Vector3d pull =
            force_ + hand_.stiffness * (hand_begin - position_) + hand_.damping * hand_velocity;
        if (rests && pull.norm() <= friction) return;
        driving -= friction * (rests ? pull : velocity_).normalized();
    }
    // Seen from the hand, which moves uniformly, the equation is linear with constant coefficients.
    const Vector3d offset = position_ - hand_begin, slip = velocity_ - hand_velocity;
    driving -= model_.damping * hand_velocity;
    const auto after = [&](Eigen::Index row) -> Vector3d {
        return transition_(row, 0) * offset + transition_(row, 1) * slip + transition_(row, 2) * driving;
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

void DynamicDevice::write(const std::array<double, 3>& force) noexcept {
    const Eigen::Map<const Vector3d> wanted(force.data());
    const double length = wanted.norm();
    commands_[next_command_] =
        length > model_.max_force ? wanted * (model_.max_force / length) : Vector3d(wanted);
    next_command_ = (next_command_ + 1) % commands_.size();
    force_ = commands_[next_command_];
}

}  // namespace palpate
