// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <vector>

#include "formats/recording/recording.hpp"
#include "formats/records/tick_result.hpp"
#include "runtime/haptics/haptic_model.hpp"

namespace palpate::session {

/// The rows of one tool of a recording, in ascending order of time; never empty. They lie in the recording,
/// which must outlive them.
using RecordedTrack = std::vector<const Tick*>;

/// The rows of a tool. Throws InvalidInput naming `file` if there is none. Linear in the recording.
RecordedTrack track_of(const recording::Recording& recording, std::int32_t tool,
                       const std::filesystem::path& file);

/// What is shown at `time` (s, to a nanosecond): the last tick by then, so that where ticks are missing the
/// one before them is held; the first one before all. Logarithmic.
const Tick& tick_at(const RecordedTrack& track, double time);

/// A recorded tick with its contacts; without any where they have been overwritten.
TickResult with_contacts(const recording::Recording& recording, const Tick& tick);

/// How many ticks are missing between the first and the last, of those that a recording of one tick of
/// `every` keeps.
std::int64_t missing_ticks(const RecordedTrack& track, std::int32_t every = 1);

/// Ticks per second of the half second that ends at `time`, as the run had them; 0 at its start.
double tick_rate_at(const RecordedTrack& track, double time);

/// What an eye could read in the window at a moment.
struct RecentFlags {
    std::uint32_t faults = no_fault;
    std::uint32_t statuses = tick_ok;
};

/// The flags of all tools' ticks in the reading_time that ends at `time` (s). Linear in those ticks.
RecentFlags flags_until(const recording::Recording& recording, double time);

/// What is felt in a tick, N.
using FeltForce = std::function<Eigen::Vector3d(const Tick& tick)>;
Eigen::Vector3d rendered_force(const Tick& tick);  ///< by the tick's own tool
/// Least and largest force (N) in each of `columns` (1 or more) equal parts of the track's time. A part
/// without a tick holds the force before it.
std::vector<Eigen::Vector2d> force_columns(const RecordedTrack& track, std::size_t columns,
                                           const FeltForce& felt = rendered_force);

/// The part of a track that shows something.
struct Demonstration {
    double begins = 0, ends = 0;  ///< s, of the recording

    /// The moment of the recording `time` s (0 or more) after its beginning, where it goes round and round.
    double around(double time) const;
};

/// From a second before the first contact, so that the approach is seen, to a second after the last; all of a
/// track that touches nothing.
Demonstration demonstration_of(const RecordedTrack& track);

/// Throws InvalidInput naming `file` if a contact is of a body or vertex that the case does not have, or not
/// finite: the case's digest says nothing about the recording's own rows. Linear in the contacts.
void check_contacts(const recording::Recording& recording, const Case& patient_case,
                    const std::filesystem::path& file);

}  // namespace palpate::session
