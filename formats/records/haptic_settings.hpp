// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "formats/records/field.hpp"

namespace palpate {

/// How the tool feels and what it may do.
struct HapticSettings {
    double tool_radius = 1.0;
    double coupling_stiffness = 0.5;  // a Touch's limit
    double max_force = 3.3;           // a Touch's limit
    double max_force_rate = 0.5;
    double friction_at_rest = 0, friction_sliding = 0;  // moist tissue under a polished tool has next to none
    double shaft_length = 0;
    double grip = 0;
};

/// Ten times and more what the devices bear that there is a back end for: a Premium 1.5 has 8.5 N and, by its
/// data sheet, 3.5 N/mm. What the device at hand bears bounds a run besides; a file that asks for more is
/// wrong or means harm.
inline constexpr double largest_max_force = 100, largest_max_force_rate = 100,
                        largest_coupling_stiffness = 100;
/// Larger than anything that goes into a patient, or slides on one.
inline constexpr double largest_tool_radius = 50, longest_shaft = 1000, largest_friction = 5;
/// N/mm²: some fifty times what a forceps' teeth bear.
inline constexpr double largest_grip = 1;

/// What each is. Sliding friction is besides at most that at rest: haptics_error().
inline constexpr std::tuple haptic_fields{
    Field("tool_radius", &HapticSettings::tool_radius, "mm", "radius of the tool's tip",
          Range{.least = 0, .most = largest_tool_radius, .ends_belong = false}),
    Field("coupling_stiffness", &HapticSettings::coupling_stiffness, "N/mm",
          "virtual coupling, the spring from device to tool",
          Range{.least = 0, .most = largest_coupling_stiffness, .ends_belong = false}),
    Field("max_force", &HapticSettings::max_force, "N", "largest force on the hand",
          Range{.least = 0, .most = largest_max_force, .ends_belong = false}),
    Field("max_force_rate", &HapticSettings::max_force_rate, "N/ms", "largest change of force in a tick",
          Range{.least = 0, .most = largest_max_force_rate, .ends_belong = false}),
    Field("friction_at_rest", &HapticSettings::friction_at_rest, "",
          "Coulomb's law: force along the surface that a resting tool bears, as part of the one across it",
          Range{.least = 0, .most = largest_friction})
        .since(2, 0.0),
    Field("friction_sliding", &HapticSettings::friction_sliding, "",
          "the same of a sliding tool, at most that of a resting one",
          Range{.least = 0, .most = largest_friction})
        .since(2, 0.0),
    Field("shaft_length", &HapticSettings::shaft_length, "mm",
          "of the tool's shaft behind its tip, as thick as the tip; 0: only the tip is felt",
          Range{.least = 0, .most = longest_shaft})
        .since(2, 0.0),
    Field("grip", &HapticSettings::grip, "N/mm²",
          "what tissue bears along the surface besides, per area that is pressed: a profile grips it",
          Range{.least = 0, .most = largest_grip})
        .written_in("kPa", 1e3)
        .since(2, 0.0)};

/// Returns what makes no sense of the settings; none if they are sound.
inline std::optional<FieldError> haptics_error(const HapticSettings& settings) {
    if (auto error = first_error(haptic_fields, settings)) return error;
    if (settings.friction_sliding <= settings.friction_at_rest) return std::nullopt;
    return FieldError{"friction_sliding", "is " + std::to_string(settings.friction_sliding),
                      "0 to friction_at_rest"};
}

}  // namespace palpate
