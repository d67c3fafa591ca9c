// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate::devices {

/// One entry of HDAPI's error stack; returned by value.
struct HdErrorInfo {
    unsigned code;
    int internal_code;  ///< the driver's own
    unsigned device;    ///< the handle of the device that it is about
};
static_assert(sizeof(HdErrorInfo) == 12);

using HdHandle = unsigned;
using HdOperation = unsigned long;  ///< a scheduled callback
using HdCallback = unsigned (*)(void* data);

/// The functions of HDAPI that are used, as a C library exports them on 64-bit Linux. Declared from public
/// descriptions of the interface; hd_library.cpp says which symbol each of them is.
struct HdApi {
    HdHandle (*init_device)(const char* name);
    void (*disable_device)(HdHandle);
    void (*make_current_device)(HdHandle);
    void (*begin_frame)(HdHandle);
    void (*end_frame)(HdHandle);
    HdErrorInfo (*get_error)();
    void (*enable)(unsigned capability);
    void (*disable)(unsigned capability);
    void (*get_integers)(unsigned parameter, int* values);
    void (*get_doubles)(unsigned parameter, double* values);
    const char* (*get_string)(unsigned parameter);
    void (*set_doubles)(unsigned parameter, const double* values);
    unsigned (*check_calibration)();
    void (*update_calibration)(unsigned style);
    void (*start_scheduler)();
    void (*stop_scheduler)();
    void (*set_scheduler_rate)(unsigned long rate_hz);
    HdOperation (*schedule_asynchronous)(HdCallback, void* data, unsigned short priority);
    void (*unschedule)(HdOperation);
};

/// HDAPI's numbers.
namespace hdapi {

inline constexpr HdHandle invalid_handle = 0xFFFFFFFF;
inline constexpr unsigned short highest_priority = 65535;

enum CallbackCode : unsigned { callback_done = 0, callback_continue = 1 };

enum ErrorCode : unsigned {
    success = 0,
    invalid_enum = 0x100,
    invalid_value = 0x101,
    invalid_operation = 0x102,
    invalid_input_type = 0x103,
    bad_handle = 0x104,
    warm_motors = 0x200,
    exceeded_max_force = 0x201,
    exceeded_max_force_impulse = 0x202,
    exceeded_max_velocity = 0x203,
    force_error = 0x204,
    device_fault = 0x300,
    device_already_initiated = 0x301,
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

enum Parameter : unsigned {
    current_buttons = 0x2000,
    current_position = 0x2050,      ///< mm, 3
    current_transform = 0x2052,     ///< 4 x 4 by columns, mm
    current_joint_angles = 0x2100,  ///< rad, 3
    device_model_type = 0x2501,
    device_serial_number = 0x2504,
    usable_workspace = 0x2551,  ///< mm, low corner, then high corner
    output_dof = 0x2554,        ///< 6: its gimbal has motors, too
    calibration_style = 0x2555,
    update_rate = 0x2600,                      ///< Hz
    nominal_max_stiffness = 0x2602,            ///< N/mm
    nominal_max_force = 0x2603,                ///< N
    nominal_max_continuous_force = 0x2604,     ///< N
    motor_temperature = 0x2605,                ///< 0 ... 1, one for each motor
    nominal_max_damping = 0x2609,              ///< N s/mm
    nominal_max_torsional_stiffness = 0x2620,  ///< N mm/rad
    nominal_max_torque = 0x2622,               ///< N mm
    nominal_max_continuous_torque = 0x2623,    ///< N mm
    current_force = 0x2700,                    ///< N, 3
    // N mm, 3, about the axes of frame D. Later headers call it deprecated for torques about the gimbal's own
    // axes (0x2704), of which no driver says where they lie; other open clients of 6-DoF Phantoms use it,
    // too.
    current_torque = 0x2701,
};

enum Capability : unsigned { force_output = 0x4000 };

enum CalibrationState : unsigned {
    calibration_ok = 0x5000,
    calibration_needs_update = 0x5001,
    calibration_needs_manual_input = 0x5002,
};

/// Flags.
enum CalibrationStyle : unsigned { encoder_reset = 1, automatic = 2, inkwell = 4 };

}  // namespace hdapi
}  // namespace palpate::devices
