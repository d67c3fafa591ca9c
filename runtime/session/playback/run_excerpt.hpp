// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

#include "formats/recording/recording.hpp"
#include "formats/records/tick_result.hpp"

namespace palpate::session {

/// Part of a run in memory, one tick of 20 with its contacts: enough to be looked at. Where that becomes
/// long it keeps one tick of twice as many, from its beginning on, and again, so that it stays within some
/// 50 MB. One thread.
class RunExcerpt {
  public:
    static constexpr std::int32_t first_every = 20;   ///< ticks: 50 rows a second
    static constexpr std::size_t most_rows = 30'000;  ///< of all tools together
    static constexpr std::size_t most_contacts = 300'000;

    /// Takes a tick of any tool; in ascending order of tick, then tool.
    void add(const TickResult& tick);
    /// Hands out what was added since the last call; its head says nothing but how many ticks lie between two
    /// rows.
    recording::Recording take();

  private:
    void append(const Tick& tick, std::span<const Contact> contacts);
    void thin();

    std::int32_t every_ = first_every;
    recording::Recording kept_;  // but for its head
};

}  // namespace palpate::session
