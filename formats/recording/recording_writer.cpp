// SPDX-License-Identifier: Apache-2.0
#include "formats/recording/recording_writer.hpp"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <string>
#include <sys/mman.h>
#include <system_error>
#include <type_traits>
#include <unistd.h>

#include "formats/asset/body_io.hpp"
#include "formats/asset/hdf5/hdf5_file.hpp"
#include "formats/asset/hdf5/hdf5_writer.hpp"
#include "formats/asset/validate.hpp"
#include "formats/model/errors.hpp"

namespace palpate::recording {
namespace {

using namespace asset;

constexpr std::int64_t contacts_per_tick = 8;  // room for so many on average

// A whole number of rows that no capacity of the host would hold anyway.
constexpr std::int64_t most_ticks = std::int64_t{1} << 32;

template <typename Visited>
Hdf5Shape extents_of(std::int64_t rows, Visited) {
    Hdf5Shape shape{static_cast<std::uint64_t>(rows)};
    if (Visited::width > 1) shape.push_back(Visited::width);
    return shape;
}

void write_tool(Hdf5Writer& writer, const ToolBody& tool) {
    writer.group("/tool");
    write_fields(writer, "/tool", tool_fields, tool.settings);
    const auto& [vertices, triangles] = tool.surface;
    if (triangles.empty()) return;
    writer.dataset<double>("/tool/vertices", {vertices.front().data(), 3 * vertices.size()},
                           {vertices.size(), 3}, "mm");
    writer.dataset<std::int32_t>("/tool/triangles", {triangles.front().data(), 3 * triangles.size()},
                                 {triangles.size(), 3});
}

void write_head(Hdf5Writer& writer, const RecordingHead& head) {
    writer.attribute("/", "schema", std::int32_t{recording_schema});
    writer.attribute("/", "palpate_version", head.palpate_version);
    writer.attribute("/", "case", head.case_name);
    writer.attribute("/", "asset_sha256", head.asset_digest);
    writer.attribute("/", "scheme", head.scheme);
    writer.attribute("/", "clock", head.clock);
    writer.attribute("/", "tools", static_cast<std::int32_t>(head.devices.size()));
    writer.attribute("/", "coupling_stiffness", head.coupling_stiffness);
    if (head.every > 1) writer.attribute("/", "every", head.every);
    writer.group("/haptics");
    write_fields(writer, "/haptics", haptic_fields, head.haptics);
    if (head.tool) write_tool(writer, *head.tool);
    if (head.jaws) {
        writer.group("/jaws");
        write_fields(writer, "/jaws", jaw_fields, *head.jaws);
    }
    if (!head.hyperelastic.empty()) {
        writer.attribute("/", "hyperelastic_bodies", static_cast<std::int32_t>(head.hyperelastic.size()));
        writer.texts("/hyperelastic", head.hyperelastic, {head.hyperelastic.size()});
    }
    std::vector<std::string> names;
    for (const RecordedDevice& device : head.devices) names.push_back(device.name);
    writer.texts("/devices/name", names, {names.size()});
    for_each_field(device_limit_fields, [&](const auto& field) {
        using Stored = decltype(numbers_of(field));
        std::vector<double> values;
        for (const RecordedDevice& device : head.devices) {
            const auto& value = device.limits.*field.member;
            const auto* first = reinterpret_cast<const double*>(&value);
            values.insert(values.end(), first, first + Stored::width);
        }
        writer.dataset<double>(column_path("/devices/", field.name), values,
                               extents_of(static_cast<std::int64_t>(names.size()), Stored{}), field.unit);
    });
}

// So that a full disk is found out now, and not as a crash in the middle of a run.
void reserve_space(const std::filesystem::path& path) {
    const std::uintmax_t size = std::filesystem::file_size(path);
    int error = ENOSPC;
    // Asked first, so that a vain attempt does not take the space from others meanwhile.
    if (std::filesystem::space(path).available > size) {
        const int file = open(path.c_str(), O_RDWR | O_CLOEXEC);
        error = file < 0 ? errno : posix_fallocate(file, 0, static_cast<off_t>(size));
        if (file >= 0) close(file);
    }
    if (error != 0)
        throw SystemFailure({path.string(),
                             "no room for " + std::to_string(size / 1'000'000 + 1) +
                                 " MB: " + std::generic_category().message(error),
                             "", "free disk space or record fewer seconds"});
}

}  // namespace

void make_recording(const std::filesystem::path& path, const RecordingHead& head, std::int64_t ticks) {
    const auto refuse = [&](const std::string& found, const std::string& expected) {
        throw InvalidInput({path.string(), found, expected, ""});
    };
    check_name(head.case_name, path.string());
    if (head.devices.empty() || head.devices.size() > most_recorded_tools)
        refuse(std::to_string(head.devices.size()) + " tools", "1 to " + std::to_string(most_recorded_tools));
    if (ticks < 2 || ticks > most_ticks) refuse(std::to_string(ticks) + " rows", "2 or more");
    if (head.every < 1 || head.every > longest_every)
        refuse("one tick of " + std::to_string(head.every), "1 to " + std::to_string(longest_every));
    for (const std::string* text : {&head.palpate_version, &head.asset_digest, &head.scheme, &head.clock})
        if (text->empty()) refuse("an empty text in the head", "");
    {
        Hdf5Writer writer(path);
        write_head(writer, head);
        const std::vector<std::int64_t> zero{0};
        for (const char* counter : {ticks_written_path, contacts_written_path, ticks_lost_path})
            writer.dataset<std::int64_t>(counter, zero, {1});
        const auto reserve = [&](const char* group, std::int64_t rows, const auto& field) {
            using Stored = decltype(numbers_of(field));
            writer.reserve<typename Stored::Number>(column_path(group, field.name),
                                                    extents_of(rows, Stored{}), field.unit);
        };
        for_each_field(tick_fields, [&](const auto& field) { reserve("/ticks/", ticks, field); });
        const std::int64_t rows = contacts_per_tick * ticks + 2 * contacts_in_transit;
        for_each_field(contact_fields, [&](const auto& field) { reserve("/contacts/", rows, field); });
        writer.close();
    }
    reserve_space(path);
}

void RecordingWriter::Close::operator()(Open* open) const noexcept {
    if (open->start) munmap(open->start, open->size);
    if (open->file >= 0) close(open->file);
    delete open;
}

RecordingWriter::RecordingWriter(const std::filesystem::path& path) : open_(new Open) {
    const Hdf5File file(path);
    const std::span<const std::byte> mapped = file.mapping().bytes();
    open_->size = mapped.size();
    open_->file = open(path.c_str(), O_RDWR | O_CLOEXEC);
    void* start = open_->file < 0
                      ? MAP_FAILED
                      : mmap(nullptr, open_->size, PROT_READ | PROT_WRITE, MAP_SHARED, open_->file, 0);
    if (start == MAP_FAILED)
        throw SystemFailure({path.string(), "cannot be mapped: " + std::generic_category().message(errno), "",
                             "check its permissions"});
    open_->start = static_cast<std::byte*>(start);
    const auto place = [&]<typename T>(std::span<const T> values) {
        return open_->start + (std::as_bytes(values).data() - mapped.data());
    };
    const auto column = [&]<typename Visited>(const std::string& name, std::int64_t rows, Visited) {
        std::vector<std::int64_t> shape{rows};
        if (Visited::width > 1) shape.push_back(Visited::width);
        return place(file.dataset<typename Visited::Number>(name, shape));
    };
    const auto counter = [&](const char* name) {
        return reinterpret_cast<std::int64_t*>(place(file.dataset<std::int64_t>(name, {1})));
    };
    ticks_written_ = counter(ticks_written_path);
    contacts_written_ = counter(contacts_written_path);
    ticks_lost_ = counter(ticks_lost_path);
    tick_capacity_ = std::ssize(file.dataset<std::int64_t>("/ticks/tick", {Hdf5File::any}));
    contact_capacity_ = std::ssize(file.dataset<std::int32_t>("/contacts/body", {Hdf5File::any}));
    if (tick_capacity_ < 2 || contact_capacity_ < 2 * contacts_in_transit || *ticks_written_ != 0)
        file.refuse("/", "is no empty recording");
    std::size_t at = 0;
    for_each_field(tick_fields, [&](const auto& field) {
        tick_columns_[at++] = column(column_path("/ticks/", field.name), tick_capacity_, numbers_of(field));
    });
    at = 0;
    for_each_field(contact_fields, [&](const auto& field) {
        contact_columns_[at++] =
            column(column_path("/contacts/", field.name), contact_capacity_, numbers_of(field));
    });
    rows_per_second_ = std::int64_t{1000} * file.attribute<std::int32_t>("/", "tools");
}

void RecordingWriter::add(Tick tick, std::span<const Contact> contacts) noexcept {
    assert(std::ssize(contacts) == tick.contact_count);
    const auto store = [](std::byte* column, std::int64_t row, const auto& record, const auto& field) {
        using Stored = typename std::remove_cvref_t<decltype(field)>::Storage;
        const auto value = static_cast<Stored>(record.*field.member);
        std::memcpy(column + row * static_cast<std::int64_t>(sizeof(value)), &value, sizeof(value));
    };
    // Rows first, their counter last: who reads meanwhile, or after a crash, sees whole rows.
    const auto publish = [](std::int64_t& counter, std::int64_t value) {
        std::atomic_ref(counter).store(value, std::memory_order_release);
    };
    tick.first_contact = *contacts_written_;
    for (std::size_t i = 0; i < contacts.size(); ++i) {
        const std::int64_t row = (tick.first_contact + static_cast<std::int64_t>(i)) % contact_capacity_;
        std::size_t at = 0;
        for_each_field(contact_fields,
                       [&](const auto& field) { store(contact_columns_[at++], row, contacts[i], field); });
    }
    publish(*contacts_written_, tick.first_contact + std::ssize(contacts));
    const std::int64_t row = *ticks_written_ % tick_capacity_;
    std::size_t at = 0;
    for_each_field(tick_fields, [&](const auto& field) { store(tick_columns_[at++], row, tick, field); });
    publish(*ticks_written_, *ticks_written_ + 1);
    // Starts to write what has changed, and waits for nothing; msync(MS_ASYNC) would do nothing on Linux.
    if (*ticks_written_ % rows_per_second_ == 0) sync_file_range(open_->file, 0, 0, SYNC_FILE_RANGE_WRITE);
}

void RecordingWriter::set_lost(std::int64_t rows) noexcept {
    *ticks_lost_ = rows;
}

void write_recording(const std::filesystem::path& path, const Recording& recording) {
    const std::int64_t rows =
        std::max(std::ssize(recording.ticks), std::ssize(recording.contacts) / contacts_per_tick + 1);
    make_recording(path, recording.head, rows + 1);  // of a full ring the oldest row does not count
    RecordingWriter writer(path);
    for (const Tick& tick : recording.ticks) writer.add(tick, recording.contacts_of(tick));
}

}  // namespace palpate::recording
