// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "formats/records/field.hpp"
#include "formats/records/haptic_settings.hpp"

namespace palpate {

/// A forceps: two jaws on one hinge, each a row of spheres that tissue feels.
struct JawSettings {
    double jaw_length = 20, jaw_radius = 2.5, jaw_opening = 60;  // about those of a laparoscopic grasper
    // Of profiled jaws, which need 3 N to hold 5 N of pull between them; smooth ones need 22 N, and that is
    // 0.11 (Heijnsdijk et al. 2004, Slip and damage properties of jaws of laparoscopic graspers, Surg Endosc
    // 18, 974).
    double jaw_friction = 0.83;
};

inline constexpr std::tuple jaw_fields{
    Field("jaw_length", &JawSettings::jaw_length, "mm", "of each jaw, from its hinge to its tip",
          Range{.least = 2, .most = 100}),
    Field("jaw_radius", &JawSettings::jaw_radius, "mm", "half the thickness of a jaw",
          Range{.least = 0.2, .most = 20}),
    Field("jaw_opening", &JawSettings::jaw_opening, "degrees", "angle between the jaws where they are open",
          Range{.least = 5, .most = 120}),
    Field("jaw_friction", &JawSettings::jaw_friction, "",
          "Coulomb's law: force along a jaw that it bears, as part of the one across it",
          Range{.least = 0, .most = largest_friction})};

/// What tissue feels of a forceps in place of a case's tool, and of what a hand may get the half that each
/// jaw may give it. What the device bears is halved where it is held: devices::jaws_of().
inline HapticSettings held_between(const JawSettings& jaws, HapticSettings settings) {
    settings.tool_radius = jaws.jaw_radius;
    settings.shaft_length = jaws.jaw_length;
    settings.friction_at_rest = settings.friction_sliding = jaws.jaw_friction;
    settings.coupling_stiffness /= 2;
    settings.max_force /= 2;
    settings.max_force_rate /= 2;
    return settings;
}

}  // namespace palpate
