// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <tuple>

#include "formats/recording/recording.hpp"

namespace palpate::recording {

/// The file stores one array for each field of formats/records: device_limit_fields, tick_fields and
/// contact_fields.

/// How a field is stored: so many numbers of one type.
template <typename T>
struct Numbers {
    using Number = T;
    static constexpr std::size_t width = 1;
};
template <typename T, std::size_t size>
struct Numbers<std::array<T, size>> {
    using Number = T;
    static constexpr std::size_t width = size;
};

template <typename Record, typename T, typename Stored>
Numbers<Stored> numbers_of(const Field<Record, T, Stored>&) {
    return {};
}

/// "/ticks/" and "force" make "/ticks/force".
inline std::string column_path(const char* group, const char* name) {
    std::string path(group);
    path += name;
    return path;
}

inline constexpr std::size_t tick_column_count = std::tuple_size_v<decltype(tick_fields)>;
inline constexpr std::size_t contact_column_count = std::tuple_size_v<decltype(contact_fields)>;

/// Where the counters lie, each a dataset of one i64.
inline constexpr const char* ticks_written_path = "/count/ticks";
inline constexpr const char* contacts_written_path = "/count/contacts";
inline constexpr const char* ticks_lost_path = "/count/lost_ticks";

inline constexpr int recording_schema = 1;

/// In a full ring of contacts, so many of the oldest may be being overwritten.
inline constexpr std::int64_t contacts_in_transit = max_contacts;

}  // namespace palpate::recording
