// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <span>
#include <string>
#include <string_view>

namespace palpate {

/// What a force-feedback device is, as the hand feels it: along each axis a mass on ideal motors.
struct DeviceModel {
    std::string name;               ///< "touch", "desktop", "premium"
    double mass_kg = 0;             ///< apparent at the tip
    double damping = 0;             ///< viscous, N s/mm
    double coulomb_friction = 0;    ///< backdrive friction, N
    double encoder_resolution = 0;  ///< of a position, mm; 0: exact
    double max_force = 0;           ///< N, motors saturate
    double max_stiffness = 0;       ///< N/mm that the device is said to render in a loop at 1 kHz
    int delay_ticks = 0;            ///< whole periods between a command and its force
};

/// The models there are figures for; each figure's source is said beside it, in device_model.cpp.
std::span<const DeviceModel> device_models();
/// By name; throws UsageError listing the names.
const DeviceModel& find_device_model(std::string_view name);

}  // namespace palpate
