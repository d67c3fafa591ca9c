// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "formats/model/image_grid.hpp"
#include "formats/model/scan.hpp"

namespace palpate::imaging {

/// Tells whether a CT is of a head: a skull takes a fifth of its height or more. A skull is where bone
/// encloses 30 cm² or more of soft tissue in sections of 10 mm together, as ribs, pelvis and spine do not.
bool shows_head(const Volume& volume);

/// Tells whether a face can be made of a CT, a head's or one with a head in it: soft tissue in front of the
/// skull, 6 mm or thicker, 20 ml or more. Not CT: false. A rendering of such a volume identifies a person.
bool shows_face(const Volume& volume);
/// The same of a scan that an asset keeps.
bool shows_face(const Scan& scan);

/// Takes the face of a CT away: from 120 mm below the skull to as much above, soft tissue in front of the
/// bone, over whose gaps a ball of 30 mm does not pass, becomes air where it is at most 40 mm thick from
/// front to back, as nose, lips, eyelids, cheeks and chin are, and the throat is not. The front is where the
/// air of nose and sinuses lies in the skull, or, where there is none, what the volume's directions say.
/// Bone, brain, ears and what is inside the nose stay.
Volume without_face(const Volume& volume);

}  // namespace palpate::imaging
