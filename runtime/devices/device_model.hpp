// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <span>
#include <string>
#include <string_view>

#include "runtime/realtime/device.hpp"

namespace palpate::devices {

/// What a force-feedback device is, as the hand feels it: along each axis a mass on ideal motors, and where
/// its gimbal has motors, about each axis an inertia on them.
struct DeviceModel {
    std::string name;                    ///< "touch", "desktop", "premium", "premium-6dof"
    double mass_kg = 0;                  ///< apparent at the tip
    double damping = 0;                  ///< viscous, N s/mm
    double coulomb_friction = 0;         ///< backdrive friction, N
    double encoder_resolution = 0;       ///< of a position, mm; 0: exact
    double max_force = 0;                ///< N, motors saturate
    double max_stiffness = 0;            ///< N/mm that the device is said to render in a loop at 1 kHz
    int delay_ticks = 0;                 ///< whole periods between a command and its force
    double max_continuous_force = 0;     ///< N, that the motors bear for ever; 0: any force
    double thermal_time_s = 1;           ///< in which the motors warm and cool by 1 - 1/e
    double inertia_kg_mm2 = 0;           ///< of tool and gimbal about the tip
    double torsional_damping = 0;        ///< viscous, N mm s/rad
    double max_torque = 0;               ///< N mm, the gimbal's motors saturate; 0: it has none
    double max_torsional_stiffness = 0;  ///< N mm/rad, as max_stiffness
    double max_continuous_torque = 0;    ///< N mm, that they bear for ever; 0: any torque
    std::array<double, 3> workspace_low{0, 0, 0};  ///< mm, corners of the usable box, frame D
    std::array<double, 3> workspace_high{0, 0, 0};
    std::string product{};  ///< what is simulated: "PHANTOM Omni"
    std::string heir{};     ///< what is sold in its place: "Touch"
};

/// What a device of this model states of itself, at 1 kHz.
DeviceLimits limits_of(const DeviceModel& model);

/// The models there are figures for; each figure's source is said beside it, in device_model.cpp.
std::span<const DeviceModel> device_models();
/// By name; throws UsageError listing the names.
const DeviceModel& find_device_model(std::string_view name);
/// What is known of a device by what it calls itself, in letters of either case: "PHANTOM Omni 4711 'Left'",
/// "Touch X", "simulated touch, scripted hand"; null if that is none of the models.
const DeviceModel* model_of_device(std::string_view device_name);

}  // namespace palpate::devices
