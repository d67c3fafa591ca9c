// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <cstring>
#include <tuple>

#include "formats/asset/body_io.hpp"
#include "formats/asset/hdf5/hdf5_file.hpp"
#include "formats/asset/validate.hpp"
#include "formats/model/errors.hpp"
#include "formats/recording/columns.hpp"
#include "formats/recording/recording.hpp"

namespace palpate::recording {
namespace {

using namespace asset;

template <typename Visited>
std::vector<std::int64_t> shape_of(std::int64_t rows, Visited) {
    if (Visited::width == 1) return {rows};
    return {rows, static_cast<std::int64_t>(Visited::width)};
}

ToolBody read_tool(const Hdf5File& file) {
    ToolBody tool;
    read_fields(file, "/tool", tool_fields, tool.settings);
    if (const auto error = first_error(tool_fields, tool.settings))
        file.refuse("/tool", error->name + " " + error->found, error->expected);
    if (!file.contains("/tool/vertices") && !file.contains("/tool/triangles")) return tool;
    const auto vertices = file.dataset<double>("/tool/vertices", {Hdf5File::any, 3});
    const auto triangles = file.dataset<std::int32_t>("/tool/triangles", {Hdf5File::any, 3});
    if (vertices.empty() || triangles.empty()) file.refuse("/tool", "has no triangle");
    tool.surface.vertices.resize(vertices.size() / 3);
    tool.surface.triangles.resize(triangles.size() / 3);
    std::ranges::copy(vertices, tool.surface.vertices.front().data());
    std::ranges::copy(triangles, tool.surface.triangles.front().data());
    check_surface(tool.surface, file.name() + ": /tool");
    return tool;
}

std::vector<std::string> read_hyperelastic(const Hdf5File& file) {
    const auto count = file.attribute<std::int32_t>("/", "hyperelastic_bodies");
    if (count < 1 || count > most_hyperelastic)
        file.refuse("/", std::to_string(count) + " hyperelastic bodies",
                    "1 to " + std::to_string(most_hyperelastic));
    std::vector<std::string> names = file.texts("/hyperelastic", {count});
    for (const std::string& name : names) check_name(name, file.name() + ": /hyperelastic");
    return names;
}

JawSettings read_jaws(const Hdf5File& file, std::int32_t tools) {
    JawSettings jaws;
    read_fields(file, "/jaws", jaw_fields, jaws);
    if (const auto error = first_error(jaw_fields, jaws))
        file.refuse("/jaws", error->name + " " + error->found, error->expected);
    if (tools != 2) file.refuse("/jaws", "with " + std::to_string(tools) + " tools", "2");
    return jaws;
}

RecordingHead read_head(const Hdf5File& file) {
    const auto schema = file.attribute<std::int32_t>("/", "schema");
    if (schema != recording_schema)
        file.refuse("/", "is of schema " + std::to_string(schema), std::to_string(recording_schema));
    RecordingHead head;
    head.palpate_version = file.text_attribute("/", "palpate_version");
    head.case_name = file.text_attribute("/", "case");
    head.asset_digest = file.text_attribute("/", "asset_sha256");
    head.scheme = file.text_attribute("/", "scheme");
    head.clock = file.text_attribute("/", "clock");
    head.coupling_stiffness = file.attribute<double>("/", "coupling_stiffness");
    check_name(head.case_name, file.name());
    if (file.has_attribute("/", "every")) head.every = file.attribute<std::int32_t>("/", "every");
    if (head.every < 1 || head.every > longest_every)
        file.refuse("/", "every " + std::to_string(head.every), "1 to " + std::to_string(longest_every));
    read_fields(file, "/haptics", haptic_fields, head.haptics);
    check_haptics(head.haptics, file.name() + ": /haptics");
    if (file.contains("/tool")) head.tool = read_tool(file);
    if (file.contains("/hyperelastic")) head.hyperelastic = read_hyperelastic(file);
    const auto tools = file.attribute<std::int32_t>("/", "tools");
    if (tools < 1 || tools > most_recorded_tools) file.refuse("/", std::to_string(tools) + " tools");
    if (file.contains("/jaws")) head.jaws = read_jaws(file, tools);
    head.devices.resize(tools);
    const std::vector<std::string> names = file.texts("/devices/name", {tools});
    for (std::size_t i = 0; i < names.size(); ++i) head.devices[i].name = names[i];
    for_each_field(device_limit_fields, [&](const auto& field) {
        const std::string path = column_path("/devices/", field.name);
        if (field.absent && !file.contains(path)) {
            for (RecordedDevice& device : head.devices) device.limits.*field.member = *field.absent;
            return;
        }
        using Stored = decltype(numbers_of(field));
        const auto values = file.dataset<double>(path, shape_of(tools, Stored{}));
        if (!std::ranges::all_of(values, [](double v) { return std::isfinite(v); }))
            file.refuse(path, "is not finite");
        for (std::size_t i = 0; i < head.devices.size(); ++i) {
            auto& value = head.devices[i].limits.*field.member;
            std::memcpy(&value, values.data() + i * Stored::width, sizeof(value));
        }
    });
    return head;
}

std::int64_t read_counter(const Hdf5File& file, const char* path) {
    const std::int64_t count = file.dataset<std::int64_t>(path, {1})[0];
    if (count < 0) file.refuse(path, "is " + std::to_string(count), "0 or more");
    return count;
}

// Rows first ... first + rows.size() - 1 of all ever written, out of the ring of `capacity` rows.
template <typename Row, typename ColumnField>
void read_column(const Hdf5File& file, const char* group, std::int64_t capacity, std::int64_t first,
                 std::vector<Row>& rows, const ColumnField& field) {
    using Stored = typename ColumnField::Storage;
    using Number = typename decltype(numbers_of(field))::Number;
    const std::string path = column_path(group, field.name);
    if (field.absent && !file.contains(path)) {
        for (Row& row : rows) row.*field.member = *field.absent;
        return;
    }
    const auto numbers = file.dataset<Number>(path, shape_of(capacity, numbers_of(field)));
    const std::span<const std::byte> bytes = std::as_bytes(numbers);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        Stored value;
        const std::int64_t row = (first + static_cast<std::int64_t>(i)) % capacity;
        std::memcpy(&value, bytes.data() + static_cast<std::size_t>(row) * sizeof(value), sizeof(value));
        rows[i].*field.member = static_cast<typename ColumnField::Value>(value);
    }
}

// The row that is written next may be half overwritten in a full ring, so it does not count.
std::int64_t read_ticks(const Hdf5File& file, Recording& recording) {
    const std::int64_t capacity = std::ssize(file.dataset<std::int64_t>("/ticks/tick", {Hdf5File::any}));
    if (capacity < 2) file.refuse("/ticks/tick", std::to_string(capacity) + " rows", "2 or more");
    recording.rows_written = read_counter(file, ticks_written_path);
    recording.rows_lost = read_counter(file, ticks_lost_path);
    if (recording.rows_written == 0)
        throw InvalidInput({file.name(), "holds no tick", "", "record a run that ticks"});
    const std::int64_t kept = std::min(recording.rows_written, capacity - 1);
    recording.ticks.resize(kept);
    for_each_field(tick_fields, [&](const auto& field) {
        read_column(file, "/ticks/", capacity, recording.rows_written - kept, recording.ticks, field);
    });
    return kept;
}

void read_contacts(const Hdf5File& file, Recording& recording) {
    const std::int64_t capacity = std::ssize(file.dataset<std::int32_t>("/contacts/body", {Hdf5File::any}));
    if (capacity < 2 * contacts_in_transit)
        file.refuse("/contacts/body", std::to_string(capacity) + " rows",
                    std::to_string(2 * contacts_in_transit) + " or more");
    const std::int64_t written = read_counter(file, contacts_written_path);
    const std::int64_t kept = std::min(written, capacity - contacts_in_transit);
    recording.contacts_before = written - kept;
    recording.contacts.resize(kept);
    for_each_field(contact_fields, [&](const auto& field) {
        read_column(file, "/contacts/", capacity, recording.contacts_before, recording.contacts, field);
    });
}

// Leaves out what never reached the disk: where the order ends, so does the recording.
void keep_what_is_in_order(const Hdf5File& file, Recording& recording) {
    std::vector<Tick>& ticks = recording.ticks;
    const auto disorder = std::ranges::adjacent_find(ticks, [](const Tick& a, const Tick& b) {
        return std::tie(a.tick, a.tool) >= std::tie(b.tick, b.tool);
    });
    if (disorder != ticks.end()) {
        recording.rows_unreadable = ticks.end() - disorder - 1;
        ticks.erase(disorder + 1, ticks.end());
    }
    const auto tools = std::ssize(recording.head.devices);
    const std::int64_t contacts = recording.contacts_before + std::ssize(recording.contacts);
    for (const Tick& row : ticks) {
        const bool sound = row.tick >= 0 && row.tool >= 0 && row.tool < tools && std::isfinite(row.time) &&
                           row.body >= -1 && row.contact_count >= 0 &&
                           row.contact_count <= static_cast<std::int32_t>(max_contacts) &&
                           row.first_contact >= 0 && row.first_contact <= contacts - row.contact_count &&
                           row.detected_tick >= -1 && row.detected_tick <= row.tick;
        if (!sound)
            file.refuse("/ticks", "the row of tick " + std::to_string(row.tick) + " contradicts itself");
    }
}

}  // namespace

std::span<const Contact> Recording::contacts_of(const Tick& tick) const {
    if (tick.first_contact < contacts_before) return {};
    return std::span(contacts).subspan(static_cast<std::size_t>(tick.first_contact - contacts_before),
                                       static_cast<std::size_t>(tick.contact_count));
}

Recording read_recording(const std::filesystem::path& path) {
    const Hdf5File file(path);
    Recording recording;
    recording.head = read_head(file);
    read_ticks(file, recording);
    read_contacts(file, recording);
    keep_what_is_in_order(file, recording);
    return recording;
}

}  // namespace palpate::recording
