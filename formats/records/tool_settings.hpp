// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "formats/records/field.hpp"

namespace palpate {

/// How a tool that turns is felt: one with a body of its own, which touches with all of it.
struct ToolSettings {
    double rod_length = 0;
    std::int32_t shell_points = 5000;
    double voxel = 1;
    double contact_stiffness = 10;
    double torsional_stiffness = 450;  // 0.5 N/mm, a Touch's, 30 mm from the tip
    double max_torque = 170;           // a Premium 1.5/6DOF's about its weakest axis, the stylus' own
    double max_torque_rate = 25;
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
