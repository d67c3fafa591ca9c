// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "formats/records/tick_result.hpp"

namespace palpate::session {

/// What the hand that holds a forceps did and felt in one tick, from what its two jaws of that length (mm)
/// did: places where their tips would meet if they closed, the shaft between theirs, the sum of their forces,
/// the larger depth, both jaws' contacts as far as there is room. No buttons: they close the jaws.
TickResult joined_jaws(const TickResult& first, const TickResult& second, double jaw_length);

}  // namespace palpate::session
