// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <string>

#include "formats/records/tick_result.hpp"

namespace palpate {

/// For how long what is gone is still shown, so that an eye can read it, s.
inline constexpr double reading_time = 2;

/// How many ticks of a run had each flag of TickStatus, how many a fault, and when each flag was there last.
class StatusCounts {
  public:
    /// Takes one tool's tick; of two tools' one tick, each counts.
    void add(const TickResult& result) noexcept;

    /// Name of each flag that was there at all, and the number of its ticks.
    std::map<std::string, std::int64_t> by_name() const;
    /// Flags that were there within reading_time of `time` (s).
    std::uint32_t recent(double time) const noexcept;
    /// A sentence on the flags that a user must know of (StatusText::told) and on faults but the run's end,
    /// with counts; empty if there were none.
    std::string closing_line() const;

  private:
    struct Count {
        std::int64_t ticks = 0;
        double last = 0;  // s
    };
    std::array<Count, status_count> counts_{};  // in the order of status_texts()
    std::int64_t faulty_ = 0;                   // ticks with a fault but the run's end
    std::uint32_t faults_ = no_fault;           // that there were
};

}  // namespace palpate
