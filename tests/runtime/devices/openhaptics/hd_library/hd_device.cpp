// SPDX-License-Identifier: Apache-2.0
#include "tests/runtime/devices/openhaptics/hd_library/hd_device.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "formats/model/arrays.hpp"
#include "runtime/devices/simulated_device.hpp"
#include "tests/runtime/devices/openhaptics/hd_library/touch_angles.hpp"

namespace palpate::hd {
namespace {

using Eigen::Vector3d;

const Vector3d no_encoder_data(0, -110, -35);  // mm: where the driver puts a tip whose angles are all zero
constexpr double velocity_smoothing = 0.1;     // of each new difference

std::unique_ptr<realtime::Device> device_of(const DeviceScript& script) {
    if (script.hand)
        return std::make_unique<devices::DynamicDevice>(script.model, *script.hand, script.path,
                                                        script.shaft);
    return std::make_unique<devices::SimulatedDevice>(script.path, DeviceLimits{}, script.shaft);
}

Vector3d within(const Vector3d& wanted, double most) {
    const double length = wanted.norm();
    return length > most ? Vector3d(wanted * (most / length)) : wanted;
}

// Along the shaft, where the device does not say more.
Eigen::Quaterniond rotation_of(const realtime::DeviceState& state) {
    const Eigen::Quaterniond told = quaternion_of(state.orientation);
    if (!told.coeffs().isZero(0)) return told;
    return Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), vector_of(state.shaft));
}

}  // namespace

HdDevice::HdDevice(const DeviceScript& script, double period)
    : impulse_limit(2 * script.model.max_force),
      script_(script),
      period_(period),
      device_(device_of(script)),
      calibration_(script.calibration) {
    tip_ = script.path.at(0);
    begin_tick(0);
    current_ = last_ = reading_;
}

bool HdDevice::has(Trouble trouble) const noexcept {
    return std::ranges::any_of(script_.troubles, [&](const TroubleSpan& span) {
        return span.trouble == trouble && span.span.contains(time_);
    });
}

double HdDevice::stalled_until(double time) const noexcept {
    double until = time;
    for (const TroubleSpan& span : script_.troubles)
        if (span.trouble == Trouble::scheduler_stall && span.span.contains(time))
            until = std::max(until, span.span.until);
    return until;
}

Code HdDevice::begin_tick(double time) noexcept {
    const double elapsed = time - time_;
    time_ = time;
    frame_done_ = false;
    const Vector3d before = tip_;
    const realtime::DeviceState state = device_->read(time);
    tip_ = vector_of(state.position);
    if (elapsed > 0) velocity_ += velocity_smoothing * ((tip_ - before) / elapsed - velocity_);
    if (has(Trouble::disconnect)) return success;
    Vector3d seen = tip_;
    if (has(Trouble::frozen_pose)) seen = no_encoder_data;
    if (has(Trouble::not_a_number)) seen.setConstant(std::numeric_limits<double>::quiet_NaN());
    reading_.velocity = has(Trouble::frozen_pose) ? Vector3d::Zero() : velocity_;
    reading_.position = seen;
    reading_.rotation = rotation_of(state).toRotationMatrix();
    reading_.joint_angles = touch_angles({seen.x(), seen.y(), seen.z()});
    reading_.buttons = 0;
    for (const ButtonSpan& press : script_.buttons)
        if (press.span.contains(time)) reading_.buttons |= 1U << press.button;
    return has(Trouble::timer_error) ? timer_error : success;
}

Code HdDevice::end_tick() noexcept {
    if (frames_open_ == 0) return success;
    frames_open_ = 0;
    wanted_ = asked_;
    return frame_error;
}

Code HdDevice::begin_frame(bool in_tick) noexcept {
    if (frames_open_ > 0) {
        ++frames_open_;
        return success;
    }
    if (in_tick && frame_done_ && capability(one_frame_limit)) return illegal_begin;
    if (has(Trouble::frame_failure)) return frame_error;
    frames_open_ = 1;
    last_ = current_;
    current_ = reading_;
    return has(Trouble::comm_error) || has(Trouble::disconnect) ? comm_error : success;
}

Code HdDevice::end_frame() noexcept {
    if (frames_open_ == 0) return illegal_end;
    if (--frames_open_ > 0) return success;
    frame_done_ = true;
    const Code refusal = refusal_of(wanted_);
    asked_ = wanted_;
    if (refusal != success) {
        power_down();
        return refusal;
    }
    if (has(Trouble::comm_error) || has(Trouble::disconnect) || !capability(force_output)) {
        power_down();
        return success;
    }
    ramp_ += ramping_rate * period_;
    const double length = asked_.norm();
    const double share = capability(force_ramping) && length > ramp_ ? ramp_ / length : 1;
    render(share * asked_, share * wanted_torque_);
    return success;
}

Code HdDevice::refusal_of(const Vector3d& force) const noexcept {
    const auto is_on = [&](unsigned which) { return capabilities_[which - force_output]; };
    if (has(Trouble::warm_motors)) return warm_motors;
    if (has(Trouble::max_force)) return exceeded_max_force;
    if (has(Trouble::velocity)) return exceeded_velocity;
    if (has(Trouble::impulse)) return exceeded_impulse;
    if (!is_on(force_output)) return success;
    if (!force.allFinite() || !wanted_torque_.allFinite()) return force_error;
    if (!is_on(software_force_limit)) return success;
    if (current_.velocity.norm() > velocity_limit) return exceeded_velocity;
    if ((force - asked_).norm() > impulse_limit) return exceeded_impulse;
    if (!is_on(max_force_clamping) && force.norm() > script_.model.max_force) return exceeded_max_force;
    return success;
}

// Motors saturate without losing the direction, whether clamping is on or not.
void HdDevice::render(const Vector3d& force, const Vector3d& torque) noexcept {
    rendered_ = within(force, script_.model.max_force);
    torque_ = within(torque, script_.model.max_torque);
    device_->write({array_of(force), array_of(torque)});
}

void HdDevice::power_down() noexcept {
    ramp_ = 0;
    render(Vector3d::Zero(), Vector3d::Zero());
}

void HdDevice::enable(unsigned which, bool on) noexcept {
    capability(which) = on;
    if (which == force_output && !on) power_down();
}

Code HdDevice::set_force(const Vector3d& force) noexcept {
    if (!in_frame()) return invalid_operation;
    wanted_ = force;
    return success;
}

Code HdDevice::set_torque(const Vector3d& torque) noexcept {
    if (!in_frame()) return invalid_operation;
    if (has_gimbal_motors()) wanted_torque_ = torque;
    return success;
}

CalibrationState HdDevice::check_calibration() const noexcept {
    if (!has(Trouble::calibration_lost)) return calibration_;
    return script_.styles == style_auto ? calibration_needs_update : calibration_needs_manual_input;
}

Code HdDevice::update_calibration(unsigned style) noexcept {
    if (!(style & script_.styles)) return invalid_value;
    if (style == style_inkwell && !script_.in_inkwell) return device_fault;
    calibration_ = calibration_ok;
    return success;
}

Hardware HdDevice::hardware() const noexcept {
    Hardware state{};
    state.time = time_;
    std::ranges::copy(tip_, state.position);
    std::ranges::copy(asked_, state.asked);
    std::ranges::copy(rendered_, state.rendered);
    std::ranges::copy(torque_, state.torque);
    return state;
}

}  // namespace palpate::hd
