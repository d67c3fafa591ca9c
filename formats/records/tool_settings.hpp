// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "formats/records/field.hpp"

namespace palpate {

/// How a tool that turns by itself is felt: a rod, or an instrument, which touches with all of its surface.
struct ToolSettings {
    double rod_length = 0;
    std::int32_t shell_points = 5000;
    double voxel = 1;
    double contact_stiffness = 10;
    double torsional_stiffness = 450;  // a Touch's 0.5 N/mm, 30 mm from the tip
    // A choice: as quoted for a Premium 1.5/6DOF about its stylus, whose data sheet was not at hand.
    double max_torque = 170;
    double max_torque_rate = 25;  // all of it within 7 ms; a choice
};

inline constexpr std::tuple tool_fields{
    Field("rod_length", &ToolSettings::rod_length, "mm",
          "of a rod behind its tip; 0: the case's shaft_length", Range{.least = 0, .most = 1000}),
    Field("shell_points", &ToolSettings::shell_points, "", "points on the tool's surface that touch",
          Range{.least = 100, .most = 100'000}),
    Field("voxel", &ToolSettings::voxel, "mm", "edge of a voxel of the distance field of rigid anatomy",
          Range{.least = 0.1, .most = 10}),
    Field("contact_stiffness", &ToolSettings::contact_stiffness, "N/mm",
          "of one point of the tool against anatomy: how hard it pushes back per depth",
          Range{.least = 1, .most = 1000}),
    Field("torsional_stiffness", &ToolSettings::torsional_stiffness, "N mm/rad",
          "virtual coupling of rotations, the spring from the device's orientation to the tool's",
          Range{.least = 1, .most = 100'000}),
    Field("max_torque", &ToolSettings::max_torque, "N mm", "largest torque on the hand",
          Range{.least = 0, .most = 10'000, .ends_belong = false}),
    Field("max_torque_rate", &ToolSettings::max_torque_rate, "N mm/ms", "largest change of torque in a tick",
          Range{.least = 0, .most = 10'000, .ends_belong = false})};

}  // namespace palpate
