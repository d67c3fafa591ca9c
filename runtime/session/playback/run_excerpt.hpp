// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <utility>

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

    /// Forgets what it has.
    void begin();
    /// Takes a tick of any tool; in ascending order of tick, then tool.
    void add(const TickResult& tick);
    /// What was taken since begin(); its head says nothing but how many ticks lie between two rows.
    const recording::Recording& recording() const { return recording_; }
    /// The same, of which nothing stays here.
    recording::Recording take() { return std::exchange(recording_, {}); }

  private:
    void thin();

    recording::Recording recording_;
};

/// Writes a recording that is in memory to `path`, over what is there. Throws as make_recording().
void write_recording(const recording::Recording& recording, const std::filesystem::path& path);

}  // namespace palpate::session
