// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/features/pair_index.hpp"

#include <algorithm>

namespace palpate::haptics {

void PairIndex::clear() noexcept {
    std::ranges::fill(slots_, Slot{});
}

std::size_t PairIndex::slot_of(std::int32_t body, std::int32_t mine, std::int32_t its) const noexcept {
    const auto mixed = (static_cast<std::uint64_t>(mine) * 0x9E3779B97F4A7C15U) ^
                       (static_cast<std::uint64_t>(its) * 0xC2B2AE3D27D4EB4FU) ^
                       static_cast<std::uint64_t>(body);
    const std::size_t last = slots_.size() - 1;
    std::size_t at = (mixed ^ mixed >> 32U) & last;
    while (slots_[at].body != none &&
           !(slots_[at].body == body && slots_[at].mine == mine && slots_[at].its == its))
        at = (at + 1) & last;
    return at;
}

std::int32_t PairIndex::find(std::int32_t body, std::int32_t mine, std::int32_t its) const noexcept {
    return slots_[slot_of(body, mine, its)].where;
}

std::int32_t& PairIndex::at(std::int32_t body, std::int32_t mine, std::int32_t its) noexcept {
    Slot& slot = slots_[slot_of(body, mine, its)];
    if (slot.body == none) slot = {body, mine, its, none};
    return slot.where;
}

}  // namespace palpate::haptics
