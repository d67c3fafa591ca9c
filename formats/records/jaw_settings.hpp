// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "formats/records/field.hpp"
#include "formats/records/haptic_settings.hpp"

namespace palpate {

/// A forceps: two jaws on one hinge, each a row of spheres that tissue feels.
struct JawSettings {
    double jaw_length = 20, jaw_radius = 2.5, jaw_opening = 60;  // about those of a laparoscopic grasper
    // Smooth jaws hold 5 N of pull between them by 22 N of pinch, which is a coefficient of 0.11; profiled
    // ones by 3 N (Heijnsdijk et al. 2004, Slip and damage properties of jaws of laparoscopic graspers, Surg
    // Endosc 18, 974). What 0.11 leaves of that, over the faces of these two jaws (each 20 x 5 mm; theirs are
    // not told in the abstract), is 22 kPa.
    double jaw_friction = 0.11, jaw_grip = 0.022;
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
          Range{.least = 0, .most = largest_friction}),
    Field("jaw_grip", &JawSettings::jaw_grip, "N/mm²",
          "what tissue bears along a jaw besides, per area that it presses: its teeth grip it",
          Range{.least = 0, .most = largest_grip})
        .written_in("kPa", 1e3)};

/// What tissue feels of a forceps in place of a case's tool, and of what a hand may get the half that each
/// jaw may give it. What the device bears is halved where it is held: devices::jaws_of().
inline HapticSettings held_between(const JawSettings& jaws, HapticSettings settings) {
    settings.tool_radius = jaws.jaw_radius;
    settings.shaft_length = jaws.jaw_length;
    settings.friction_at_rest = settings.friction_sliding = jaws.jaw_friction;
    settings.grip = jaws.jaw_grip;
    settings.coupling_stiffness /= 2;
    settings.max_force /= 2;
    settings.max_force_rate /= 2;
    return settings;
}

}  // namespace palpate
