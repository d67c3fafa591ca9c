// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "formats/model/body.hpp"

namespace palpate {

/// Most contact points of one tick of one tool.
inline constexpr std::int32_t most_recorded_contacts = 64;
/// Most tools of one run.
inline constexpr std::int32_t most_recorded_tools = 64;

/// A device as it was when the run began. Zero: not known.
struct RecordedDevice {
    std::string name;
    double max_force = 0;                          ///< N
    double max_stiffness = 0;                      ///< N/mm
    double damping = 0;                            ///< N s/mm
    double max_continuous_force = 0;               ///< N
    double rate_hz = 0;                            ///< of its servo
    std::array<double, 3> workspace_low{0, 0, 0};  ///< mm
    std::array<double, 3> workspace_high{0, 0, 0};
};

/// What a run was of.
struct RecordingHead {
    std::string palpate_version;
    std::string case_name;
    std::string asset_digest;             ///< asset_digest() of what was touched
    std::string scheme;                   ///< how contact was found: "continuous", "single" or "twice"
    std::string clock;                    ///< "real" or "virtual"
    double coupling_stiffness = 0;        ///< N/mm, of the virtual coupling
    HapticSettings haptics;               ///< the asset's
    std::vector<RecordedDevice> devices;  ///< one for each tool
};

/// One tick of one tool: what came in, what went out, and when. Positions and forces in frame P.
struct RecordedTick {
    std::int64_t tick = 0;                           ///< 0 for the run's first
    std::int32_t tool = 0;                           ///< which one, from 0 on
    double time = 0;                                 ///< s since the loop started
    std::array<double, 3> device_position{0, 0, 0};  ///< mm
    std::array<double, 3> shaft{0, 0, 0};            ///< unit, or zero where it is not known
    std::int64_t buttons = 0;                        ///< one bit each
    std::int32_t faults = 0;                         ///< flags: why the force was taken away
    std::int32_t status = 0;                         ///< flags: what was unusual about contacts and force
    std::array<double, 3> tool_position{0, 0, 0};    ///< mm, at the other end of the virtual coupling
    std::array<double, 3> force{0, 0, 0};            ///< N, on the device
    double depth = 0;                                ///< mm
    double residual = 0;                             ///< mm
    std::int32_t body = -1;                          ///< the deepest touched, -1 for none
    std::int32_t contact_count = 0;
    std::int64_t first_contact = 0;   ///< of how many contacts were recorded before: set by the writer
    std::int64_t detected_tick = -1;  ///< whose position a published scheme's detection was of, -1 for none
    std::int64_t tick_ns = 0;         ///< read, contact, force, write
    std::int64_t wake_latency_ns = 0;
    std::int64_t overruns = 0;  ///< periods skipped so far
};

/// One contact point of one tick.
struct RecordedContact {
    std::int32_t body = 0;
    std::int32_t part = 0;      ///< of the tool: 0 the tip, then along its shaft
    std::int32_t triangle = 0;  ///< of the body's surface; -1 if the point is a vertex
    std::array<std::int32_t, 3> vertices{-1, -1, -1};
    std::array<float, 3> weights{0, 0, 0};
    std::array<float, 3> normal{0, 0, 0};    ///< unit, from tissue to tool
    float gap = 0;                           ///< mm
    float force = 0;                         ///< N, along the normal
    float series_compliance = 0;             ///< mm/N
    std::array<float, 3> friction{0, 0, 0};  ///< N, on the tool
};

/// What a recording still holds of a run, oldest first.
struct Recording {
    RecordingHead head;
    std::vector<RecordedTick> ticks;  ///< in ascending order of tick, then tool
    std::vector<RecordedContact> contacts;
    std::int64_t contacts_before = 0;  ///< recorded before `contacts` and overwritten since
    std::int64_t rows_written = 0;     ///< rows of ticks ever written
    std::int64_t rows_lost = 0;        ///< that the run could not hand over in time
    std::int64_t rows_unreadable = 0;  ///< at the end, that never reached the disk whole

    /// The contacts of one of `ticks`; none where they have been overwritten.
    std::span<const RecordedContact> contacts_of(const RecordedTick& tick) const;
};

/// Reads a recording, also one whose run was killed. Every dimension, count and index is
/// checked, and the order of ticks; a row out of order, as a loss of power leaves it, ends the recording.
/// Throws InvalidInput naming the file if it is damaged otherwise or holds no tick. Cost: that of the file's
/// size.
Recording read_recording(const std::filesystem::path& path);

}  // namespace palpate
