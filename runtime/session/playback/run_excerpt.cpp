// SPDX-License-Identifier: Apache-2.0
#include "runtime/session/playback/run_excerpt.hpp"

#include <algorithm>

#include "formats/recording/recording_writer.hpp"

namespace palpate::session {

using namespace recording;

void RunExcerpt::begin() {
    recording_ = {};
    recording_.head.every = first_every;
}

void RunExcerpt::add(const TickResult& tick) {
    if (tick.tick % recording_.head.every != 0) return;
    if (recording_.ticks.size() >= most_rows || recording_.contacts.size() + max_contacts > most_contacts)
        thin();
    if (tick.tick % recording_.head.every != 0) return;
    Tick row = tick;
    row.first_contact = static_cast<std::int64_t>(recording_.contacts.size());
    recording_.ticks.push_back(row);
    const auto contacts = tick.active_contacts();
    recording_.contacts.insert(recording_.contacts.end(), contacts.begin(), contacts.end());
    ++recording_.rows_written;
}

void RunExcerpt::thin() {
    Recording thinned;
    thinned.head.every = 2 * recording_.head.every;
    for (const Tick& tick : recording_.ticks) {
        if (tick.tick % thinned.head.every != 0) continue;
        const auto contacts = recording_.contacts_of(tick);
        thinned.ticks.push_back(tick);
        thinned.ticks.back().first_contact = static_cast<std::int64_t>(thinned.contacts.size());
        thinned.contacts.insert(thinned.contacts.end(), contacts.begin(), contacts.end());
    }
    thinned.rows_written = std::ssize(thinned.ticks);
    recording_ = std::move(thinned);
}

void write_recording(const Recording& recording, const std::filesystem::path& path) {
    // A ring counts as full with one row less, and has so many contacts for each.
    constexpr std::int64_t contacts_per_row = 8;
    const std::int64_t rows =
        std::max(std::ssize(recording.ticks), std::ssize(recording.contacts) / contacts_per_row + 1);
    make_recording(path, recording.head, rows + 1);
    RecordingWriter writer(path);
    for (const Tick& tick : recording.ticks) writer.add(tick, recording.contacts_of(tick));
}

}  // namespace palpate::session
