// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/model/body.hpp"
#include "formats/records/device_limits.hpp"
#include "formats/records/haptic_settings.hpp"
#include "formats/records/jaw_settings.hpp"
#include "formats/records/tick_result.hpp"

namespace palpate::recording {

/// Most tools of one run.
inline constexpr std::int32_t most_recorded_tools = 64;
/// Most ticks from one of its rows to the next.
inline constexpr std::int32_t longest_every = 1'000'000;
/// Most bodies that it says to be hyperelastic.
inline constexpr std::int32_t most_hyperelastic = 1024;

/// A device as it was when the run began.
struct RecordedDevice {
    std::string name;
    DeviceLimits limits;
};

/// What a run was of.
struct RecordingHead {
    std::string palpate_version;
    std::string case_name;
    std::string asset_digest;             ///< asset_digest() of what was touched
    std::string scheme;                   ///< how contact was found: "continuous" or another of the runtime's
    std::string clock;                    ///< "real" or "virtual"
    double coupling_stiffness = 0;        ///< N/mm, of the virtual coupling
    HapticSettings haptics;               ///< the asset's, or what a forceps put in their place
    std::vector<RecordedDevice> devices;  ///< one for each tool
    std::optional<ToolBody> tool{};       ///< what was held, if it had a body of its own
    std::optional<JawSettings> jaws{};    ///< of a forceps, whose jaws are tools 0 and 1
    std::vector<std::string> hyperelastic{};  ///< deformable bodies whose tissue was neo-Hookean
    std::int32_t every = 1;                   ///< it keeps one tick of so many: 1: all, as a replay needs
};

/// What a recording still holds of a run, oldest first.
struct Recording {
    RecordingHead head;
    std::vector<Tick> ticks;  ///< in ascending order of tick, then tool
    std::vector<Contact> contacts;
    std::int64_t contacts_before = 0;  ///< recorded before `contacts` and overwritten since
    std::int64_t rows_written = 0;     ///< rows of ticks ever written
    std::int64_t rows_lost = 0;        ///< that the run could not hand over in time
    std::int64_t rows_unreadable = 0;  ///< at the end, that never reached the disk whole

    /// The contacts of one of `ticks`; none where they have been overwritten.
    std::span<const Contact> contacts_of(const Tick& tick) const;
};

/// Reads a recording, also one whose run was killed. Every dimension, count and index is
/// checked, and the order of ticks; a row out of order, as a loss of power leaves it, ends the recording.
/// Throws InvalidInput naming the file if it is damaged otherwise or holds no tick. Cost: that of the file's
/// size.
Recording read_recording(const std::filesystem::path& path);

}  // namespace palpate::recording
