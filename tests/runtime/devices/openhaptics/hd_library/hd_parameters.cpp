// SPDX-License-Identifier: Apache-2.0
// hdGet..., hdSet..., hdEnable and their like.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

#include "tests/runtime/devices/openhaptics/hd_library/hd_library.hpp"

namespace palpate::hd {
namespace {

using namespace devices;
using Eigen::Vector3d;

enum Type : unsigned { boolean = 1, integer = 2, real = 4, number = integer | real };

// What a parameter is now, and which of the functions may be asked for it.
struct Value {
    unsigned types = real;
    std::size_t count = 0;
    std::array<double, 16> numbers{};
    bool of_a_frame = false;
};

Value value_of(unsigned types, std::initializer_list<double> numbers, bool of_a_frame = false) {
    Value value{types, numbers.size(), {}, of_a_frame};
    std::ranges::copy(numbers, value.numbers.begin());
    return value;
}

Value state_of(const Vector3d& v) {
    return value_of(real, {v[0], v[1], v[2]}, true);
}

// Column by column.
Value transform_of(const Eigen::Matrix3d& r, const Vector3d& p) {
    return value_of(real,
                    {r(0, 0), r(1, 0), r(2, 0), 0, r(0, 1), r(1, 1), r(2, 1), 0, r(0, 2), r(1, 2), r(2, 2), 0,
                     p[0], p[1], p[2], 1},
                    true);
}

// A value that a frame holds; `parameter` is the current one's code.
std::optional<Value> state_value(const Snapshot& state, unsigned parameter) {
    switch (parameter) {
        case buttons:
            return value_of(integer, {static_cast<double>(state.buttons)}, true);
        case current_position:
            return state_of(state.position);
        case current_velocity:
            return state_of(state.velocity);
        case current_transform:
            return transform_of(state.rotation, state.position);
        case current_angular_velocity:
            return state_of(Vector3d::Zero());
        case current_joint_angles:
            return value_of(real, {state.joint_angles[0], state.joint_angles[1], state.joint_angles[2]},
                            true);
        case current_gimbal_angles:
            return state_of(Vector3d::Zero());
        default:
            return std::nullopt;
    }
}

// Corners of the box that the data sheet gives, around the origin.
Value workspace_of(const DeviceModel& model) {
    if (model.name.starts_with("premium")) return value_of(real, {-190.5, -133.5, -95.5, 190.5, 133.5, 95.5});
    const double z = model.name == "touch" ? 35 : 60;
    return value_of(real, {-80, -60, -z, 80, 60, z});
}

double continuous_force_of(const DeviceModel& model) {
    return model.name == "touch" ? 0.88 : model.name == "desktop" ? 1.75 : 1.4;
}

std::optional<Value> get(Library& library, HdDevice& device, unsigned parameter) {
    const DeviceModel& model = device.script().model;
    if (const auto value = state_value(device.current(), parameter)) return value;
    if (parameter >= last_of_current)
        if (const auto value = state_value(device.last(), parameter - last_of_current)) return value;
    switch (parameter) {
        case safety_switch:
            return value_of(boolean, {1}, true);
        case inkwell_switch:
            return value_of(boolean, {device.in_inkwell() ? 1.0 : 0.0}, true);
        case encoder_values: {
            Value counts = value_of(integer, {0, 0, 0, 0, 0, 0}, true);
            constexpr double per_radian = 4096;
            for (std::size_t i = 0; i < 3; ++i)
                counts.numbers[i] = std::floor(per_radian * device.current().joint_angles[i]);
            return counts;
        }
        case max_workspace:
        case usable_workspace:
            return workspace_of(model);
        case tabletop_offset:
            return value_of(real, {-110});
        case input_dof:
            return value_of(integer, {6});
        case output_dof:
            return value_of(integer, {device.has_gimbal_motors() ? 6.0 : 3.0});
        case calibration_style:
            return value_of(integer, {static_cast<double>(device.script().styles)});
        case update_rate:
            return value_of(number, {static_cast<double>(library.scheduler.rate_hz())});
        case instantaneous_rate:
            return value_of(number, {std::round(library.scheduler.instantaneous_rate())});
        case nominal_max_stiffness:
            return value_of(real, {model.max_stiffness});
        case nominal_max_force:
            return value_of(real, {model.max_force});
        case nominal_max_continuous_force:
            return value_of(real, {continuous_force_of(model)});
        case motor_temperature:
            return value_of(real, {device.temperature(), device.temperature(), device.temperature()});
        case velocity_limit:
            return value_of(real, {device.velocity_limit});
        case impulse_limit:
            return value_of(real, {device.impulse_limit});
        case ramping_rate:
            return value_of(real, {device.ramping_rate});
        case nominal_max_damping:
            return value_of(real, {0.003});
        case current_force:
            return state_of(device.force());
        case nominal_max_torsional_stiffness:
            return value_of(real, {model.max_torsional_stiffness});
        case nominal_max_torsional_damping:
            return value_of(real, {model.torsional_damping});
        case nominal_max_torque:
            return value_of(real, {model.max_torque});
        case nominal_max_continuous_torque:
            return value_of(real, {model.max_continuous_torque});
        case current_torque:
            return state_of(device.torque());
        case current_joint_torque:
        case current_gimbal_torque:
            return state_of(Vector3d::Zero());
        default:
            return std::nullopt;
    }
}

template <class T>
void get_as(unsigned type, unsigned parameter, T* out) {
    Library& lib = library();
    const std::lock_guard lock(lib.mutex);
    HdDevice* device = lib.require_current();
    if (!device) return;
    const std::optional<Value> value = get(lib, *device, parameter);
    if (!value)
        lib.report(invalid_enum, lib.current);
    else if (!(value->types & type))
        lib.report(invalid_input_type, lib.current);
    else if (!out)
        lib.report(invalid_value, lib.current);
    else if (value->of_a_frame && !device->in_frame())
        lib.report(invalid_operation, lib.current);
    else
        for (std::size_t i = 0; i < value->count; ++i) out[i] = static_cast<T>(value->numbers[i]);
}

// One positive, finite number.
template <class T>
Code set_limit(double& limit, const T* in) {
    const auto wanted = static_cast<double>(*in);
    if (!(wanted > 0 && std::isfinite(wanted))) return invalid_value;
    limit = wanted;
    return success;
}

template <class T>
Code set(HdDevice& device, unsigned type, unsigned parameter, const T* in) {
    switch (parameter) {
        case current_force:
        case current_torque:
        case current_joint_torque:
        case current_gimbal_torque:
        case velocity_limit:
        case impulse_limit:
        case ramping_rate:
            break;
        default:
            return invalid_enum;
    }
    if (type != real) return invalid_input_type;
    if (!in) return invalid_value;
    switch (parameter) {
        case velocity_limit:
            return set_limit(device.velocity_limit, in);
        case impulse_limit:
            return set_limit(device.impulse_limit, in);
        case ramping_rate:
            return set_limit(device.ramping_rate, in);
        case current_force:
            return device.set_force(
                {static_cast<double>(in[0]), static_cast<double>(in[1]), static_cast<double>(in[2])});
        case current_torque:
            return device.set_torque(
                {static_cast<double>(in[0]), static_cast<double>(in[1]), static_cast<double>(in[2])});
        default:
            return device.in_frame() ? success : invalid_operation;  // about joints: not simulated
    }
}

template <class T>
void set_as(unsigned type, unsigned parameter, const T* in) {
    Library& lib = library();
    const std::lock_guard lock(lib.mutex);
    if (HdDevice* device = lib.require_current()) lib.report(set(*device, type, parameter, in), lib.current);
}

// The current device, if the capability is one.
HdDevice* device_with(unsigned capability) {
    Library& lib = library();
    HdDevice* device = lib.require_current();
    if (device && (capability < force_output || capability > one_frame_limit)) {
        lib.report(invalid_enum, lib.current);
        return nullptr;
    }
    return device;
}

void enable(unsigned capability, bool on) {
    const std::lock_guard lock(library().mutex);
    if (HdDevice* device = device_with(capability)) device->enable(capability, on);
}

const char* text_of(const HdDevice& device, unsigned parameter) {
    switch (parameter) {
        case version:
            return "3.4.0";
        case device_model:
            return device.script().model.name.c_str();
        case device_driver:
            return "conformance library";
        case device_vendor:
            return "Palpate";
        case device_serial:
            return device.script().name.c_str();
        case device_firmware:
            return "1.0";
        default:
            return nullptr;
    }
}

}  // namespace
}  // namespace palpate::hd

using namespace palpate::hd;

extern "C" void hdGetBooleanv(unsigned parameter, unsigned char* out) {
    get_as(boolean, parameter, out);
}
extern "C" void hdGetIntegerv(unsigned parameter, int* out) {
    get_as(integer, parameter, out);
}
extern "C" void hdGetFloatv(unsigned parameter, float* out) {
    get_as(real, parameter, out);
}
extern "C" void hdGetDoublev(unsigned parameter, double* out) {
    get_as(real, parameter, out);
}
extern "C" void hdGetLongv(unsigned parameter, long* out) {
    get_as(integer, parameter, out);
}
extern "C" void hdSetBooleanv(unsigned parameter, const unsigned char* in) {
    set_as(boolean, parameter, in);
}
extern "C" void hdSetIntegerv(unsigned parameter, const int* in) {
    set_as(integer, parameter, in);
}
extern "C" void hdSetFloatv(unsigned parameter, const float* in) {
    set_as(real, parameter, in);
}
extern "C" void hdSetDoublev(unsigned parameter, const double* in) {
    set_as(real, parameter, in);
}
extern "C" void hdSetLongv(unsigned parameter, const long* in) {
    set_as(integer, parameter, in);
}

extern "C" const char* hdGetString(unsigned parameter) {
    Library& lib = library();
    const std::lock_guard lock(lib.mutex);
    const HdDevice* device = lib.require_current();
    if (!device) return nullptr;
    const char* text = text_of(*device, parameter);
    if (!text) lib.report(invalid_enum, lib.current);
    return text;
}

extern "C" void hdEnable(unsigned capability) {
    enable(capability, true);
}
extern "C" void hdDisable(unsigned capability) {
    enable(capability, false);
}
extern "C" unsigned char hdIsEnabled(unsigned capability) {
    const std::lock_guard lock(library().mutex);
    HdDevice* device = device_with(capability);
    return device && device->capability(capability) ? 1 : 0;
}
