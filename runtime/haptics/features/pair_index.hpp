// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace palpate::haptics {

/// Where pairs of a tool's and a body's pieces are in a list, by hash: open addressing in a table that is
/// allocated once, as the standard library's maps are not. Everything but the constructor is realtime-safe.
class PairIndex {
  public:
    static constexpr std::int32_t none = -1;

    /// For as many pairs as half of `slots`, a power of two (both unchecked).
    explicit PairIndex(std::size_t slots) : slots_(slots) {}

    void clear() noexcept;
    /// What was written for a pair, or none.
    std::int32_t find(std::int32_t body, std::int32_t mine, std::int32_t its) const noexcept;
    /// The same, to be written where it is none.
    std::int32_t& at(std::int32_t body, std::int32_t mine, std::int32_t its) noexcept;

  private:
    struct Slot {
        std::int32_t body = none, mine = 0, its = 0, where = none;
    };
    std::size_t slot_of(std::int32_t body, std::int32_t mine, std::int32_t its) const noexcept;

    std::vector<Slot> slots_;
};

}  // namespace palpate::haptics
