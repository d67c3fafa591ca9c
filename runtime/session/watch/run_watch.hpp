// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "formats/records/status_counts.hpp"
#include "runtime/haptics/servo_loop.hpp"
#include "runtime/realtime/file_watch.hpp"
#include "runtime/session/watch/fault_log.hpp"

namespace palpate::session {

/// What stands beside a loop that runs against the clock: tells it when the asset's file is gone, and the
/// user of each fault once.
class RunWatch {
  public:
    /// `tell` gets a sentence for each fault when it begins. `loop` must outlive this. `asset` empty: not
    /// watched, for a loop that runs against no clock.
    RunWatch(const std::filesystem::path& asset, haptics::ServoLoop& loop,
             std::function<void(const std::string&)> tell);

    /// Takes every result that the loop's ring gives.
    void add(const TickResult& result) {
        log_.add(result);
        statuses_.add(result);
    }

    /// Flags of the faults that were there within reading_time of `time` (s).
    std::uint32_t recent(double time) const;
    /// Of all tools' ticks.
    const StatusCounts& statuses() const { return statuses_; }
    /// [{fault, tool, from_s, until_s}, ...]; tool is null for a fault of the whole run.
    nlohmann::ordered_json faults_json() const;

  private:
    FaultLog log_;
    StatusCounts statuses_;
    std::optional<realtime::FileWatch> asset_;
};

}  // namespace palpate::session
