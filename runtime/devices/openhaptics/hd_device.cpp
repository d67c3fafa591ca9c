// SPDX-License-Identifier: Apache-2.0
#include "runtime/devices/openhaptics/hd_device.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "formats/model/arrays.hpp"

namespace palpate::devices {
namespace {

using namespace realtime;
using namespace hdapi;

// The pose that all joint angles zero give: the workspace's offset in the Touch's published configuration.
constexpr std::array<double, 3> pose_without_data{0, -110, -35};  // mm
constexpr double pose_rounding = 1e-6;                            // mm

constexpr std::size_t most_motors = 16;  // more than any device has

// What drivers call the default device: HDAPI's null pointer, then the configurations' names that they
// install (of the Touch driver; of the Phantom Device Drivers, which open by this name only on some Omnis).
constexpr std::array<const char*, 3> default_names{nullptr, "Default Device", "Default PHANToM"};

// Whether another name may open the device.
bool may_be_the_name(unsigned code) {
    return code != device_already_initiated && code != invalid_licence;
}

std::string text_of(const HdApi& api, unsigned parameter) {
    const char* text = api.get_string(parameter);
    const bool failed = take_hd_errors(api).code != success;
    return failed || !text ? "" : text;
}

// How the stylus is turned, by the axes of its transform, which lie one after the other and may be of any
// length.
void take_axes(const std::array<double, 16>& transform, DeviceState& state) {
    const Eigen::Map<const Eigen::Matrix4d> X(transform.data());
    Eigen::Vector3d x = X.block<3, 1>(0, 0), z = X.block<3, 1>(0, 2);
    if (!(z.norm() > 0)) return;
    z.normalize();
    state.shaft = array_of(z);
    x -= x.dot(z) * z;
    if (!(x.norm() > 0)) return;
    x.normalize();
    Eigen::Matrix3d R;
    R << x, z.cross(x), z;
    state.orientation = array_of(Eigen::Quaterniond(R));
}

}  // namespace

HdDevice::HdDevice(const HdApi& api, HdErrorSorter& errors, const std::string& name, bool or_default)
    : api_(api), errors_(errors) {
    const std::string culprit = name.empty() ? "the default device" : "device '" + name + "'";
    if (const HdErrorInfo error = open_one_of(name, or_default); handle_ == invalid_handle)
        throw SystemFailure(explain_hd_error(culprit, error));
    try {
        api_.make_current_device(handle_);
        api_.enable(force_output);
        if (const HdErrorInfo error = take_hd_errors(api_); error.code != success)
            throw SystemFailure(explain_hd_error(culprit + ", force output", error));
        describe(name);
        errors_.add(handle_);
    } catch (...) {
        api_.disable_device(handle_);
        throw;
    }
}

HdDevice::~HdDevice() {
    api_.make_current_device(handle_);
    api_.disable(force_output);
    api_.disable_device(handle_);
    take_hd_errors(api_);
}

// Returns the first error of those met; none if the device is open.
HdErrorInfo HdDevice::open_one_of(const std::string& name, bool or_default) {
    HdErrorInfo first{};
    if (!name.empty()) {
        first = open(name.c_str());
        if (first.code == success || !or_default || !may_be_the_name(first.code)) return first;
    }
    for (const char* known : default_names) {
        const HdErrorInfo error = open(known);
        opened_instead_ = error.code == success && !name.empty();
        if (error.code == success) return error;
        if (first.code == success) first = error;
        if (!may_be_the_name(error.code)) return first;
    }
    return first;
}

HdErrorInfo HdDevice::open(const char* name) {
    take_hd_errors(api_);  // what is left there is not about this
    const HdHandle handle = api_.init_device(name);
    HdErrorInfo error = take_hd_errors(api_);
    if (error.code != success && handle != invalid_handle) api_.disable_device(handle);
    if (error.code == success && handle == invalid_handle) error.code = device_fault;
    if (error.code == success) handle_ = handle;
    return error;
}

void HdDevice::describe(const std::string& name) {
    const std::string model = text_of(api_, device_model_type), serial = text_of(api_, device_serial_number);
    label_ = model.empty() ? "HDAPI device" : model;
    if (!serial.empty()) label_ += ' ' + serial;
    if (!name.empty()) label_ += (opened_instead_ ? ", default device for '" : " '") + name + '\'';

    limits_.max_force = nominal(nominal_max_force);
    limits_.max_continuous_force = nominal(nominal_max_continuous_force);
    limits_.max_stiffness = nominal(nominal_max_stiffness);
    limits_.max_damping = nominal(nominal_max_damping);
    describe_torque();
    ask_rate();
    std::array<double, 6> box{};
    api_.get_doubles(usable_workspace, box.data());
    if (take_hd_errors(api_).code == success) {
        limits_.workspace_low = {box[0], box[1], box[2]};
        limits_.workspace_high = {box[3], box[4], box[5]};
    }
    int styles = 0;
    api_.get_integers(calibration_style, &styles);
    if (take_hd_errors(api_).code == success) calibration_styles_ = static_cast<unsigned>(styles);
}

// A device with motors in its gimbal says so and how strong they are. One that does not say how strong, or
// whose driver refuses a frame of zero torque, gets none.
void HdDevice::describe_torque() {
    int degrees = 0;
    api_.get_integers(output_dof, &degrees);
    if (take_hd_errors(api_).code != success || degrees < 6) return;
    constexpr std::array<double, 3> none{0, 0, 0};
    api_.begin_frame(handle_);
    api_.set_doubles(current_torque, none.data());
    api_.end_frame(handle_);
    if (take_hd_errors(api_).code != success) return;
    limits_.max_torque = std::max(0.0, nominal(nominal_max_torque));
    limits_.max_continuous_torque = std::max(0.0, nominal(nominal_max_continuous_torque));
    limits_.max_torsional_stiffness = std::max(0.0, nominal(nominal_max_torsional_stiffness));
    renders_torque_ = limits_.max_torque > 0;
}

void HdDevice::ask_rate() {
    api_.make_current_device(handle_);
    int rate = 0;
    api_.get_integers(update_rate, &rate);
    limits_.rate_hz = take_hd_errors(api_).code == success ? rate : nominal(update_rate);
}

// Zero where the driver does not know.
double HdDevice::nominal(unsigned parameter) const {
    double value = 0;
    api_.get_doubles(parameter, &value);
    return take_hd_errors(api_).code == success && std::isfinite(value) ? value : 0;
}

void HdDevice::calibrate() {
    const unsigned style = calibration_styles_ & automatic ? automatic : calibration_styles_ & inkwell;
    if (style == 0) return;
    api_.make_current_device(handle_);
    api_.update_calibration(style);
    look_now_.store(true);
}

std::string HdDevice::how_to_calibrate() const {
    if (calibration_styles_ & inkwell) return "put the stylus into its inkwell and start again";
    if (calibration_styles_ & automatic)
        return "move the stylus slowly through its whole reach and start again";
    return "hold the arm in its reset position (links at right angles, gimbal level), calibrate it with the "
           "driver's setup program, and start again";
}

DeviceState HdDevice::read(double time) noexcept {
    if (!in_frame_) api_.begin_frame(handle_);
    in_frame_ = true;
    DeviceState state;
    state.time = time;
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    state.position = {none, none, none};  // stays where the driver fails without a word
    api_.get_doubles(current_position, state.position.data());
    // The stylus' own z axis goes from its tip along the shaft: OpenHaptics' examples draw their cursor, a
    // cone with the tip at the origin and its body along +z, with this transform as it is.
    std::array<double, 16> transform{};
    api_.get_doubles(current_transform, transform.data());
    take_axes(transform, state);
    int buttons = 0;
    api_.get_integers(current_buttons, &buttons);
    state.buttons = static_cast<std::uint32_t>(buttons);

    const bool is_frozen = frozen(state.position);
    if (look_now_.exchange(false) || --ticks_to_look_ <= 0) look();
    errors_.drain();
    state.faults = errors_.take(handle_);
    if (state.faults & motors_warm) warm_ = true;
    if (warm_) state.faults |= motors_warm;
    if (is_frozen) state.faults |= pose_frozen;
    if (misplaced_) state.faults |= not_calibrated;
    // The last pose stands for one that is not there, and for one that may be of encoders without data: a
    // tool must not be dragged or turned there before the doubt has become a fault.
    const bool given = std::ranges::all_of(state.position, [](double x) { return std::isfinite(x); });
    const bool doubted = ticks_frozen_ > 0 && placed_;
    if (given && !doubted && !(state.faults & distrusted_position) && !speed_.plausible(state.position, time))
        state.faults |= implausible_speed;
    else if (given && !doubted) {
        position_ = state.position;
        shaft_ = state.shaft;
        orientation_ = state.orientation;
        placed_ = ticks_frozen_ == 0;
    }
    if (!given && !(state.faults & distrusted_position)) return state;
    state.position = position_;
    state.shaft = shaft_;
    state.orientation = orientation_;
    return state;
}

void HdDevice::write(const Wrench& wrench) noexcept {
    if (!in_frame_) return;
    in_frame_ = false;
    api_.make_current_device(handle_);
    api_.set_doubles(current_force, wrench.force.data());
    if (renders_torque_) api_.set_doubles(current_torque, wrench.torque.data());
    api_.end_frame(handle_);
    errors_.drain();
}

void HdDevice::look() noexcept {
    ticks_to_look_ = look_ticks;
    std::array<double, most_motors> temperatures{};
    api_.get_doubles(motor_temperature, temperatures.data());
    const double warmest = *std::ranges::max_element(temperatures);
    warm_ = warmest >= (warm_ ? motors_cool : 1);
    const Calibration calibration = ask_calibration();
    misplaced_ = calibration != Calibration::ok;
    calibration_.store(calibration);
}

Calibration HdDevice::ask_calibration() noexcept {
    switch (api_.check_calibration()) {
        case calibration_needs_manual_input:
            return Calibration::needs_manual_input;
        case calibration_needs_update:
            return calibration_styles_ & (automatic | inkwell) ? Calibration::needs_update
                                                               : Calibration::needs_manual_input;
        default:
            return Calibration::ok;
    }
}

// Whether the pose has been that of encoders without data for more than frozen_ticks.
bool HdDevice::frozen(const std::array<double, 3>& position) noexcept {
    bool same = true;
    for (std::size_t i = 0; i < 3; ++i)
        same = same && std::abs(position[i] - pose_without_data[i]) <= pose_rounding;
    if (same) {
        std::array<double, 3> angles{1, 1, 1};
        api_.get_doubles(current_joint_angles, angles.data());
        same = std::ranges::all_of(angles, [](double angle) { return angle == 0; });
    }
    ticks_frozen_ = same ? std::min(ticks_frozen_ + 1, frozen_ticks + 1) : 0;
    return ticks_frozen_ > frozen_ticks;
}

}  // namespace palpate::devices
