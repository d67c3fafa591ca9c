// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "formats/records/tick_result.hpp"

namespace palpate::session {

/// What the hand that holds a forceps did and felt in one tick, from what its two jaws did: places halfway
/// between the jaws' tips, the sum of their forces, the larger depth, both jaws' contacts as far as there is
/// room.
TickResult joined_jaws(const TickResult& first, const TickResult& second);

/// Whether both jaws press tissue in such a tick's parts.
inline bool takes_hold(const TickResult& first, const TickResult& second) {
    return first.contact_count > 0 && second.contact_count > 0;
}

}  // namespace palpate::session
