// SPDX-License-Identifier: Apache-2.0
#include "runtime/devices/device_model.hpp"

#include <algorithm>
#include <array>

#include "formats/model/errors.hpp"

namespace palpate {
namespace {

// Nobody publishes a device's damping. It is put where the stated stiffness is the most that sampling leaves
// stable, K = 2 b / T at T = 1 ms (Colgate, Schenkel 1997), so that the model renders what the device is
// known to render and no more.
constexpr double damping_for(double max_stiffness) {
    constexpr double period = 1e-3;  // s
    return max_stiffness * period / 2;
}

// Mass at the tip, backdrive friction, resolution: as quoted from the data sheets of SensAble Technologies
// and 3D Systems; the sheets themselves were not at hand to check them by.
const std::array<DeviceModel, 3> models{{
    {.name = "touch",  // PHANTOM Omni
     .mass_kg = 0.045,
     .damping = damping_for(0.5),
     .coulomb_friction = 0.26,
     .encoder_resolution = 0.055,
     .max_force = 3.3,      // HDAPI, HD_NOMINAL_MAX_FORCE
     .max_stiffness = 0.5,  // HDAPI, HD_NOMINAL_MAX_STIFFNESS
     .delay_ticks = 0},
    {.name = "desktop",  // PHANTOM Desktop, Touch X
     .mass_kg = 0.045,
     .damping = damping_for(1.0),
     .coulomb_friction = 0.06,
     .encoder_resolution = 0.023,
     .max_force = 7.9,      // HDAPI
     .max_stiffness = 1.0,  // what CHAI3D 3.3 allows it
     .delay_ticks = 0},
    {.name = "premium",  // PHANTOM Premium 1.5
     .mass_kg = 0.075,
     .damping = damping_for(0.8),
     .coulomb_friction = 0.04,
     .encoder_resolution = 0.03,
     .max_force = 8.5,      // data sheet
     .max_stiffness = 0.8,  // what CHAI3D 3.3 allows it
     .delay_ticks = 0},
}};

}  // namespace

std::span<const DeviceModel> device_models() {
    return models;
}

const DeviceModel& find_device_model(std::string_view name) {
    const auto found = std::ranges::find(models, name, &DeviceModel::name);
    if (found != models.end()) return *found;
    std::string names;
    for (const DeviceModel& model : models) names += (names.empty() ? "" : ", ") + model.name;
    throw UsageError({"--device", std::string(name), names, ""});
}

}  // namespace palpate
