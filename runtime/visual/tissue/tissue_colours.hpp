// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string_view>

#include "formats/model/body.hpp"
#include "runtime/visual/actors.hpp"

namespace palpate::visual {

/// How a structure looks.
struct TissueLook {
    Rgb colour;            ///< of its surface
    float wetness = 0.4F;  ///< how much of the light shines off it, 0 ... 1
};

/// Chooses a look by a structure's name, in whatever words a label map has it: 'kidney_left', 'Left Kidney'
/// and 'kidney' are one. A name that is not known gets a muted colour of its own, the same each time. Known
/// names cover TotalSegmentator's classes for CT and MRI. Colours are chosen by eye after how organs look in
/// open and laparoscopic operations, for no table of measured albedos covers them; neighbours differ in
/// lightness too, so that they stay apart for eyes that tell few hues.
TissueLook tissue_look(std::string_view name);

/// The look of a body that is rigid, or of a deformable one by its region of most volume (by its own name
/// where that has none): what the names suggest, in the colour that the asset asks for, if it does.
TissueLook look_of(const RigidBody& body);
TissueLook look_of(const DeformableBody& body);

/// The colour that the asset asks for in a region.
std::optional<Rgb> chosen_colour(const DeformableBody& body, std::int32_t region);

}  // namespace palpate::visual
