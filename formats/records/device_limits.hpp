// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>

#include "formats/records/field.hpp"

namespace palpate {

/// What a device can render. Zero: not known.
struct DeviceLimits {
    double max_force = 0;             // N
    double max_stiffness = 0;         // N/mm
    double damping = 0;               // N s/mm
    double max_continuous_force = 0;  // N
    double rate_hz = 0;
    std::array<double, 3> workspace_low{0, 0, 0};   // mm, frame D
    std::array<double, 3> workspace_high{0, 0, 0};  // mm, frame D
    double max_damping = 0;                         // N s/mm
    double max_torque = 0;                          // N mm; zero: it renders none
    double max_continuous_torque = 0;               // N mm
    double max_torsional_stiffness = 0;             // N mm/rad
    double torsional_damping = 0;                   // N mm s/rad
};

inline constexpr std::tuple device_limit_fields{
    Field("max_force", &DeviceLimits::max_force, "N", "largest force"),
    Field("max_stiffness", &DeviceLimits::max_stiffness, "N/mm", "stiffest spring that it renders"),
    Field("damping", &DeviceLimits::damping, "N s/mm", "of the device itself"),
    Field("max_continuous_force", &DeviceLimits::max_continuous_force, "N",
          "that the motors bear for as long as one likes"),
    Field("rate_hz", &DeviceLimits::rate_hz, "Hz", "of its servo"),
    Field("workspace_low", &DeviceLimits::workspace_low, "mm",
          "least corner of the box that the tip reaches"),
    Field("workspace_high", &DeviceLimits::workspace_high, "mm", "greatest corner of that box"),
    Field("max_damping", &DeviceLimits::max_damping, "N s/mm", "strongest damping that it renders")
        .since(1, 0.0),
    Field("max_torque", &DeviceLimits::max_torque, "N mm", "largest torque; 0: it renders none")
        .since(1, 0.0),
    Field("max_continuous_torque", &DeviceLimits::max_continuous_torque, "N mm",
          "torque that the motors bear for as long as one likes")
        .since(1, 0.0),
    Field("max_torsional_stiffness", &DeviceLimits::max_torsional_stiffness, "N mm/rad",
          "stiffest torsional spring that it renders")
        .since(1, 0.0),
    Field("torsional_damping", &DeviceLimits::torsional_damping, "N mm s/rad", "of the device as it turns")
        .since(1, 0.0)};

}  // namespace palpate
