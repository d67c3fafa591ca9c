// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

#include "formats/recording/recording.hpp"

namespace palpate {

/// The file stores one array per field; these lists are the only place that names them, for the writer and
/// the reader. `visit` gets a column's name, its unit and the member.

template <typename Visit>
void visit_tick_columns(Visit&& visit) {
    visit("tick", "", &RecordedTick::tick);
    visit("tool", "", &RecordedTick::tool);
    visit("time", "s", &RecordedTick::time);
    visit("device_position", "mm", &RecordedTick::device_position);
    visit("shaft", "", &RecordedTick::shaft);
    visit("buttons", "", &RecordedTick::buttons);
    visit("faults", "", &RecordedTick::faults);
    visit("status", "", &RecordedTick::status);
    visit("tool_position", "mm", &RecordedTick::tool_position);
    visit("force", "N", &RecordedTick::force);
    visit("depth", "mm", &RecordedTick::depth);
    visit("residual", "mm", &RecordedTick::residual);
    visit("body", "", &RecordedTick::body);
    visit("contact_count", "", &RecordedTick::contact_count);
    visit("first_contact", "", &RecordedTick::first_contact);
    visit("detected_tick", "", &RecordedTick::detected_tick);
    visit("tick_ns", "ns", &RecordedTick::tick_ns);
    visit("wake_latency_ns", "ns", &RecordedTick::wake_latency_ns);
    visit("overruns", "", &RecordedTick::overruns);
}
inline constexpr std::size_t tick_column_count = 19;

template <typename Visit>
void visit_contact_columns(Visit&& visit) {
    visit("body", "", &RecordedContact::body);
    visit("part", "", &RecordedContact::part);
    visit("triangle", "", &RecordedContact::triangle);
    visit("vertices", "", &RecordedContact::vertices);
    visit("weights", "", &RecordedContact::weights);
    visit("normal", "", &RecordedContact::normal);
    visit("gap", "mm", &RecordedContact::gap);
    visit("force", "N", &RecordedContact::force);
    visit("series_compliance", "mm/N", &RecordedContact::series_compliance);
    visit("friction", "N", &RecordedContact::friction);
}
inline constexpr std::size_t contact_column_count = 10;

/// The figures of a device, in the order of their columns; `visit` gets name, unit and member.
template <typename Visit>
void visit_device_columns(Visit&& visit) {
    visit("max_force", "N", &RecordedDevice::max_force);
    visit("max_stiffness", "N/mm", &RecordedDevice::max_stiffness);
    visit("damping", "N s/mm", &RecordedDevice::damping);
    visit("max_continuous_force", "N", &RecordedDevice::max_continuous_force);
    visit("rate_hz", "Hz", &RecordedDevice::rate_hz);
    visit("workspace_low", "mm", &RecordedDevice::workspace_low);
    visit("workspace_high", "mm", &RecordedDevice::workspace_high);
}

/// How a field of type T is stored: so many numbers of one type.
template <typename T>
struct Field {
    using Number = T;
    static constexpr std::size_t width = 1;
};
template <typename T, std::size_t size>
struct Field<std::array<T, size>> {
    using Number = T;
    static constexpr std::size_t width = size;
};

template <typename Row, typename T>
Field<T> field_of(T Row::*) {
    return {};
}

/// Where the counters lie, each a dataset of one i64.
inline constexpr const char* ticks_written_path = "/count/ticks";
inline constexpr const char* contacts_written_path = "/count/contacts";
inline constexpr const char* ticks_lost_path = "/count/lost_ticks";

inline constexpr int recording_schema = 1;

/// In a full ring of contacts, so many of the oldest may be being overwritten.
inline constexpr std::int64_t contacts_in_transit = most_recorded_contacts;

}  // namespace palpate
