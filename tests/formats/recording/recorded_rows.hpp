// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <functional>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <initializer_list>
#include <vector>

#include "formats/recording/columns.hpp"
#include "formats/recording/recording_writer.hpp"

namespace palpate::recording {

inline RecordingHead two_tools() {
    return {.palpate_version = "1.2.3",
            .case_name = "sample",
            .asset_digest = std::string(64, 'a'),
            .scheme = "continuous",
            .clock = "real",
            .coupling_stiffness = 0.4,
            .haptics = {.tool_radius = 1.5, .friction_at_rest = 0.25, .shaft_length = 7},
            .devices = {{"left", {.max_force = 3.3, .workspace_high = {1, 2, 3}}},
                        {"right", {.max_stiffness = 0.5, .damping = 2e-4, .max_damping = 3e-3}}}};
}

// Values of which no two rows share any, told by the row's number alone.
template <typename Row, typename Table>
Row numbered(std::int64_t number, const Table& table) {
    Row row;
    int column = 0;
    for_each_field(table, [&](const auto& field) {
        using Held = Numbers<typename std::remove_cvref_t<decltype(field)>::Value>;
        auto* values = reinterpret_cast<typename Held::Number*>(&(row.*field.member));
        for (std::size_t i = 0; i < Held::width; ++i)
            values[i] =
                static_cast<typename Held::Number>(100 * number + 4 * column + static_cast<std::int64_t>(i));
        ++column;
    });
    return row;
}

inline Contact contact_of(std::int64_t number) {
    return numbered<Contact>(number, contact_fields);
}

inline Tick tick_of(std::int64_t row, std::int32_t contacts) {
    auto tick = numbered<Tick>(row, tick_fields);
    tick.tick = row / 2;
    tick.tool = static_cast<std::int32_t>(row % 2);
    tick.contact_count = contacts;
    tick.detected_tick = tick.tick - 1;
    return tick;
}

inline std::int32_t contacts_in(std::int64_t row, std::int32_t most) {
    return static_cast<std::int32_t>(row * 7 % (most + 1));
}

inline void add_rows(RecordingWriter& writer, std::int64_t end, std::int32_t most_contacts,
                     std::int64_t row = 0) {
    std::int64_t contacts = 0;
    for (; row < end; ++row) {
        std::vector<Contact> points(static_cast<std::size_t>(contacts_in(row, most_contacts)));
        for (Contact& point : points) point = contact_of(contacts++);
        writer.add(tick_of(row, static_cast<std::int32_t>(points.size())), points);
    }
}

template <typename Row, typename Table>
void expect_same(const Row& found, const Row& expected, const Table& table) {
    for_each_field(table, [&](const auto& field) {
        EXPECT_EQ(found.*field.member, expected.*field.member) << field.name;
    });
}

// Every kept row is what was added, and so are its contacts unless they are gone.
inline void expect_rows(const Recording& recording, std::int64_t written, std::int32_t most_contacts) {
    std::vector<std::int64_t> first_contact{0};
    for (std::int64_t row = 0; row < written; ++row)
        first_contact.push_back(first_contact.back() + contacts_in(row, most_contacts));
    const std::int64_t first = written - std::ssize(recording.ticks);
    for (std::size_t i = 0; i < recording.ticks.size(); ++i) {
        const std::int64_t row = first + static_cast<std::int64_t>(i);
        Tick expected = tick_of(row, contacts_in(row, most_contacts));
        expected.first_contact = first_contact[static_cast<std::size_t>(row)];
        expect_same(recording.ticks[i], expected, tick_fields);
        const auto contacts = recording.contacts_of(recording.ticks[i]);
        if (expected.first_contact < recording.contacts_before) {
            EXPECT_TRUE(contacts.empty());
            continue;
        }
        ASSERT_EQ(std::ssize(contacts), expected.contact_count);
        for (std::size_t k = 0; k < contacts.size(); ++k)
            expect_same(contacts[k], contact_of(expected.first_contact + static_cast<std::int64_t>(k)),
                        contact_fields);
    }
}

inline void edit(const std::filesystem::path& path, const std::function<void(hid_t)>& action) {
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110);
    const hid_t file = H5Fopen(path.c_str(), H5F_ACC_RDWR, access);
    action(file);
    H5Fclose(file);
    H5Pclose(access);
}

// Takes datasets out of a recording, as if it had been made before there were any.
inline void take_out(const std::filesystem::path& path, std::initializer_list<const char*> datasets) {
    edit(path, [&](hid_t file) {
        for (const char* dataset : datasets) ASSERT_GE(H5Ldelete(file, dataset, H5P_DEFAULT), 0) << dataset;
    });
}

}  // namespace palpate::recording
