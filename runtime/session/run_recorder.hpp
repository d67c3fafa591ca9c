// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "formats/recording/recording.hpp"
#include "formats/recording/recording_writer.hpp"
#include "formats/records/tick_result.hpp"
#include "runtime/haptics/haptic_model.hpp"
#include "runtime/realtime/device.hpp"

namespace palpate::session {

/// What a recording says of a run of `model` with one of `devices` for each tool, once it is coupled to them.
/// `asset`: the file that `patient_case` is from; its digest is read. `clock`: "real" or "virtual". Throws
/// InvalidInput if it is no asset.
recording::RecordingHead recording_head(const std::filesystem::path& asset, const Case& patient_case,
                                        const haptics::HapticModel& model,
                                        std::span<realtime::Device* const> devices, const std::string& clock,
                                        const std::string& version);

/// What a device said in a recorded tick, with every fault of that tick, whoever told of it.
realtime::DeviceState state_of(const Tick& tick);

/// How many rows a recording of `seconds` of a run with `tools` tools has. Throws UsageError if that is
/// less than 0.01 s or more than 12 days.
std::int64_t recording_rows(double seconds, std::size_t tools);

/// Puts ticks into a recording, outside the haptic thread.
class RunRecorder {
  public:
    /// Opens what make_recording() made; throws as RecordingWriter does.
    explicit RunRecorder(const std::filesystem::path& path) : writer_(path) {}

    void add(const TickResult& result) noexcept;
    /// Says how many results could not be added, as ServoLoop counts them.
    void set_lost(std::uint64_t results) noexcept;
    std::int64_t rows() const noexcept { return rows_; }  ///< added so far

  private:
    recording::RecordingWriter writer_;
    std::int64_t rows_ = 0;
};

}  // namespace palpate::session
