// SPDX-License-Identifier: Apache-2.0
#include "runtime/devices/device_model.hpp"

#include <algorithm>
#include <array>
#include <cctype>

#include "formats/model/errors.hpp"

namespace palpate::devices {
namespace {

// Nobody publishes a device's damping. It is put where the stated stiffness is the most that sampling leaves
// stable, K = 2 b / T at T = 1 ms (Colgate, Schenkel 1997), so that the model renders what the device is
// known to render and no more.
constexpr double damping_for(double max_stiffness) {
    constexpr double period = 1e-3;  // s
    return max_stiffness * period / 2;
}

// A choice: nobody publishes how fast the motors of these devices warm. Small motors take seconds in their
// windings and minutes as a whole; this lies between, and lets a Touch render its largest force for 7 s.
constexpr double thermal_time_s = 100;

// Mass at the tip, backdrive friction, resolution, size of the workspace: as quoted from the data sheets of
// SensAble Technologies and 3D Systems; the sheets themselves were not at hand to check them by. That the
// workspace's middle is D's origin is a choice; a Touch's arm reaches all of it so
// (test_phantom_kinematics.cpp).
//
// Of the gimbal's motors: largest and lasting torque are those about the stylus, as quoted likewise; about
// the two other axes it is said to give 515 and 188 N mm. Its inertia is a choice, a rod of 45 g and 120 mm
// about its middle, and so is its torsional stiffness: max_stiffness 30 mm from the tip.
const std::array<DeviceModel, 4> models{{
    {.name = "touch",
     .mass_kg = 0.045,
     .damping = damping_for(0.5),
     .coulomb_friction = 0.26,
     .encoder_resolution = 0.055,
     .max_force = 3.3,      // HDAPI, HD_NOMINAL_MAX_FORCE
     .max_stiffness = 0.5,  // HDAPI, HD_NOMINAL_MAX_STIFFNESS
     .delay_ticks = 0,
     .max_continuous_force = 0.88,  // HDAPI, HD_NOMINAL_MAX_CONTINUOUS_FORCE
     .thermal_time_s = thermal_time_s,
     .workspace_low = {-80, -60, -35},
     .workspace_high = {80, 60, 35},
     .product = "PHANTOM Omni",
     .heir = "Touch"},
    {.name = "desktop",
     .mass_kg = 0.045,
     .damping = damping_for(1.0),
     .coulomb_friction = 0.06,
     .encoder_resolution = 0.023,
     .max_force = 7.9,      // HDAPI
     .max_stiffness = 1.0,  // what CHAI3D 3.3 allows it
     .delay_ticks = 0,
     .max_continuous_force = 1.75,  // data sheet
     .thermal_time_s = thermal_time_s,
     .workspace_low = {-80, -60, -60},
     .workspace_high = {80, 60, 60},
     .product = "PHANTOM Desktop",
     .heir = "Touch X"},
    {.name = "premium",
     .mass_kg = 0.075,
     .damping = damping_for(0.8),
     .coulomb_friction = 0.04,
     .encoder_resolution = 0.03,
     .max_force = 8.5,      // data sheet
     .max_stiffness = 0.8,  // what CHAI3D 3.3 allows it
     .delay_ticks = 0,
     .max_continuous_force = 1.4,  // as a public stand-in for HDAPI states it
     .thermal_time_s = thermal_time_s,
     .workspace_low = {-190.5, -133.5, -95.5},
     .workspace_high = {190.5, 133.5, 95.5},
     .product = "PHANTOM Premium 1.5"},
    {.name = "premium-6dof",
     .mass_kg = 0.136,
     .damping = damping_for(0.8),
     .coulomb_friction = 0.04,
     .encoder_resolution = 0.03,
     .max_force = 8.5,
     .max_stiffness = 0.8,
     .delay_ticks = 0,
     .max_continuous_force = 1.4,
     .thermal_time_s = thermal_time_s,
     .inertia_kg_mm2 = 54,
     .torsional_damping = damping_for(720),
     .max_torque = 170,
     .max_torsional_stiffness = 720,
     .max_continuous_torque = 48,
     .workspace_low = {-190.5, -133.5, -95.5},
     .workspace_high = {190.5, 133.5, 95.5},
     .product = "PHANTOM Premium 1.5/6DOF"},
}};

char lower(char letter) {
    return static_cast<char>(std::tolower(static_cast<unsigned char>(letter)));
}

}  // namespace

DeviceLimits limits_of(const DeviceModel& model) {
    return {.max_force = model.max_force,
            .max_stiffness = model.max_stiffness,
            .damping = model.damping,
            .max_continuous_force = model.max_continuous_force,
            .rate_hz = 1000,
            .workspace_low = model.workspace_low,
            .workspace_high = model.workspace_high,
            .max_torque = model.max_torque,
            .max_continuous_torque = model.max_continuous_torque,
            .max_torsional_stiffness = model.max_torsional_stiffness,
            .torsional_damping = model.torsional_damping};
}

std::span<const DeviceModel> device_models() {
    return models;
}

const DeviceModel& find_device_model(std::string_view name) {
    const auto found = std::ranges::find(models, name, &DeviceModel::name);
    if (found != models.end()) return *found;
    std::string names;
    for (const DeviceModel& model : models) names += (names.empty() ? "" : ", ") + model.name;
    throw UsageError({"device model", std::string(name), names, ""});
}

const DeviceModel* model_of_device(std::string_view device_name) {
    const auto calls_itself = [&](const std::string& name) {
        return !name.empty() && device_name.size() >= name.size() &&
               std::ranges::equal(name, device_name.substr(0, name.size()), {}, lower, lower);
    };
    const DeviceModel* found = nullptr;
    std::size_t longest = 0;  // so that a Touch X is no Touch
    for (const DeviceModel& model : models)
        for (const std::string& name : {model.product, model.heir, "simulated " + model.name + ","})
            if (calls_itself(name) && name.size() > longest) {
                found = &model;
                longest = name.size();
            }
    return found;
}

}  // namespace palpate::devices
