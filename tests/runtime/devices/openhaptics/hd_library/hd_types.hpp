// SPDX-License-Identifier: Apache-2.0
#pragma once

/// HDAPI's types and numbers in our own words: public facts about its C interface.
namespace palpate::hd {

/// Returned by value.
struct ErrorInfo {
    unsigned code;
    int internal;
    unsigned device;
};
static_assert(sizeof(ErrorInfo) == 12);

using Handle = unsigned;
using Callback = unsigned (*)(void*);
inline constexpr Handle invalid_handle = 0xFFFFFFFF;

enum Code : unsigned {
    success = 0,
    invalid_enum = 0x100,
    invalid_value = 0x101,
    invalid_operation = 0x102,
    invalid_input_type = 0x103,
    bad_handle = 0x104,
    warm_motors = 0x200,
    exceeded_max_force = 0x201,
    exceeded_impulse = 0x202,
    exceeded_velocity = 0x203,
    force_error = 0x204,
    device_fault = 0x300,
    already_initiated = 0x301,
    comm_error = 0x302,
    comm_config_error = 0x303,
    timer_error = 0x304,
    illegal_begin = 0x400,
    illegal_end = 0x401,
    frame_error = 0x402,
    invalid_priority = 0x500,
    scheduler_full = 0x501,
    invalid_licence = 0x600,
};

enum CallbackCode : unsigned { callback_done = 0, callback_continue = 1 };

enum Parameter : unsigned {
    buttons = 0x2000,
    safety_switch = 0x2001,
    inkwell_switch = 0x2002,
    encoder_values = 0x2010,
    current_position = 0x2050,
    current_velocity = 0x2051,
    current_transform = 0x2052,
    current_angular_velocity = 0x2053,
    current_joint_angles = 0x2100,
    current_gimbal_angles = 0x2150,
    last_of_current = 0x200,  // added to the code of a current value: that of the frame before
    last_buttons = 0x2200,
    last_position = 0x2250,
    version = 0x2500,
    device_model = 0x2501,
    device_driver = 0x2502,
    device_vendor = 0x2503,
    device_serial = 0x2504,
    device_firmware = 0x2505,
    max_workspace = 0x2550,
    usable_workspace = 0x2551,
    tabletop_offset = 0x2552,
    input_dof = 0x2553,
    output_dof = 0x2554,
    calibration_style = 0x2555,
    update_rate = 0x2600,
    instantaneous_rate = 0x2601,
    nominal_max_stiffness = 0x2602,
    nominal_max_force = 0x2603,
    nominal_max_continuous_force = 0x2604,
    motor_temperature = 0x2605,
    velocity_limit = 0x2606,
    impulse_limit = 0x2607,
    ramping_rate = 0x2608,
    nominal_max_damping = 0x2609,
    nominal_max_torsional_stiffness = 0x2620,
    nominal_max_torsional_damping = 0x2621,
    nominal_max_torque = 0x2622,
    nominal_max_continuous_torque = 0x2623,
    current_force = 0x2700,
    current_torque = 0x2701,
    current_joint_torque = 0x2703,
    current_gimbal_torque = 0x2704,
};

enum Capability : unsigned {
    force_output = 0x4000,
    max_force_clamping = 0x4001,
    force_ramping = 0x4002,
    software_force_limit = 0x4003,
    one_frame_limit = 0x4004,
};

enum CalibrationState : unsigned {
    calibration_ok = 0x5000,
    calibration_needs_update = 0x5001,
    calibration_needs_manual_input = 0x5002,
};

enum CalibrationStyle : unsigned { style_reset = 1, style_auto = 2, style_inkwell = 4 };

/// What stands at the hardware's side of a device of the conformance library; not part of HDAPI.
struct Hardware {
    double time;         ///< s: ticks so far times the period
    double position[3];  ///< of the tip, true, frame D, mm
    double asked[3];     ///< the force of the last frame that ended, N
    double rendered[3];  ///< what the motors make of it, N
    double torque[3];    ///< what those of the gimbal make, N mm, frame D
};

}  // namespace palpate::hd
