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
};

/// What each is. Sliding friction is besides at most that at rest: haptics_error().
inline constexpr std::tuple haptic_fields{
    Field("tool_radius", &HapticSettings::tool_radius, "mm", "radius of the tool's tip", positive),
    Field("coupling_stiffness", &HapticSettings::coupling_stiffness, "N/mm",
          "virtual coupling, the spring from device to tool", positive),
    Field("max_force", &HapticSettings::max_force, "N", "largest force on the hand", positive),
    Field("max_force_rate", &HapticSettings::max_force_rate, "N/ms", "largest change of force in a tick",
          positive),
    Field("friction_at_rest", &HapticSettings::friction_at_rest, "",
          "Coulomb's law: force along the surface that a resting tool bears, as part of the one across it",
          not_negative)
        .since(2, 0.0),
    Field("friction_sliding", &HapticSettings::friction_sliding, "",
          "the same of a sliding tool, at most that of a resting one", not_negative)
        .since(2, 0.0),
    Field("shaft_length", &HapticSettings::shaft_length, "mm",
          "of the tool's shaft behind its tip, as thick as the tip; 0: only the tip is felt", not_negative)
        .since(2, 0.0)};

/// Returns what makes no sense of the settings; none if they are sound.
inline std::optional<FieldError> haptics_error(const HapticSettings& settings) {
    if (auto error = first_error(haptic_fields, settings)) return error;
    if (settings.friction_sliding <= settings.friction_at_rest) return std::nullopt;
    return FieldError{"friction_sliding", "is " + std::to_string(settings.friction_sliding),
                      "0 to friction_at_rest"};
}

}  // namespace palpate
