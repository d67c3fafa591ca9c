// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include "formats/recording/columns.hpp"
#include "formats/recording/recording.hpp"

namespace palpate::recording {

/// Makes a recording (formats/recording/SPEC.md) without a tick: a ring of `ticks` rows (at least 2), and one
/// of 8 contacts per row, with their space on the disk reserved. 0.8 kB per row. Throws InvalidInput if the
/// head makes no sense, SystemFailure if the disk has no room.
void make_recording(const std::filesystem::path& path, const RecordingHead& head, std::int64_t ticks);

/// Fills a recording. Each row is a store into the mapped file, so what has been added survives the end of
/// the process, however it ends; about once a second the rows are sent on their way to the disk, for a loss
/// of power. One thread; not realtime-safe, for it may wait for memory or disk: the logger's side of a ring.
class RecordingWriter {
  public:
    /// Opens what make_recording() made; throws InvalidInput if it is something else, SystemFailure if it
    /// cannot be mapped. Nobody may shorten the file meanwhile.
    explicit RecordingWriter(const std::filesystem::path& path);

    /// Adds a row and its contacts, tick.contact_count of them (asserted), over the oldest ones where the
    /// rings are full. Sets first_contact itself. Ticks must come in ascending order of tick, then tool.
    void add(Tick tick, std::span<const Contact> contacts) noexcept;
    /// Says how many rows could not be handed over so far.
    void set_lost(std::int64_t rows) noexcept;

  private:
    struct Open {
        int file = -1;
        std::byte* start = nullptr;
        std::size_t size = 0;
    };
    struct Close {
        void operator()(Open* open) const noexcept;
    };

    std::unique_ptr<Open, Close> open_;
    std::array<std::byte*, tick_column_count> tick_columns_{};
    std::array<std::byte*, contact_column_count> contact_columns_{};
    std::int64_t *ticks_written_ = nullptr, *contacts_written_ = nullptr, *ticks_lost_ = nullptr;
    std::int64_t tick_capacity_ = 0, contact_capacity_ = 0;
    std::int64_t rows_per_second_ = 1000;
};

/// Writes a recording that is in memory, in a file as long as it needs. Throws as make_recording() and
/// RecordingWriter.
void write_recording(const std::filesystem::path& path, const Recording& recording);

}  // namespace palpate::recording
