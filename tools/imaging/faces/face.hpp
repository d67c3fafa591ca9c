// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "formats/model/image_grid.hpp"

namespace palpate::imaging {

/// Tells whether a CT shows a head, whose sections are smaller than those of a trunk: 35 000 mm² on average,
/// where adults' heads have some 22 000 and their trunks 50 000 and more.
bool shows_head(const Volume& volume);

/// Tells whether a face can be made of a CT: a head's, with soft tissue in front of its bone (20 ml or more
/// of what without_face() takes away). Not CT: false. A rendering of such a volume identifies a person.
bool shows_face(const Volume& volume);

/// Takes the face of a head's CT away: soft tissue in front of the bone, over whose gaps a ball of 30 mm
/// does not pass, becomes air, where it is at most 40 mm thick from front to back, as nose, lips, eyelids,
/// cheeks and chin are, and the throat is not. The patient's front is that of the volume's directions. Bone,
/// brain, ears and what is inside the nose stay.
Volume without_face(const Volume& volume);

}  // namespace palpate::imaging
