// SPDX-License-Identifier: Apache-2.0
#include "runtime/session/playback/recorded_track.hpp"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "formats/model/arrays.hpp"
#include "formats/model/errors.hpp"
#include "formats/records/status_counts.hpp"
#include "runtime/session/touch_target.hpp"

namespace palpate::session {

using namespace recording;

RecordedTrack track_of(const Recording& recording, std::int32_t tool, const std::filesystem::path& file) {
    RecordedTrack track;
    for (const Tick& row : recording.ticks)
        if (row.tool == tool) track.push_back(&row);
    if (track.empty())
        throw InvalidInput({file.string(), "no tick of tool " + std::to_string(tool),
                            "tools from 0 to " + std::to_string(recording.head.devices.size() - 1),
                            "choose another with --tool"});
    return track;
}

const Tick& tick_at(const RecordedTrack& track, double time) {
    constexpr double rounding = 1e-9;  // s, of times that come to a tick's own
    const auto later =
        std::ranges::upper_bound(track, time + rounding, {}, [](const Tick* tick) { return tick->time; });
    return later == track.begin() ? *track.front() : **(later - 1);
}

TickResult with_contacts(const Recording& recording, const Tick& tick) {
    TickResult result{};
    static_cast<Tick&>(result) = tick;
    const auto contacts = recording.contacts_of(tick);
    result.contact_count = static_cast<std::int32_t>(contacts.size());
    std::ranges::copy(contacts, result.contacts.begin());
    return result;
}

std::int64_t missing_ticks(const RecordedTrack& track, std::int32_t every) {
    return (track.back()->tick - track.front()->tick) / every + 1 - std::ssize(track);
}

double tick_rate_at(const RecordedTrack& track, double time) {
    constexpr double span = 0.5;  // s
    const Tick& now = tick_at(track, time);
    const Tick& before = tick_at(track, now.time - span);
    const double passed = now.time - before.time;
    return passed > 0 ? static_cast<double>(now.tick - before.tick) / passed : 0;
}

RecentFlags flags_until(const Recording& recording, double time) {
    RecentFlags flags;
    const auto since = std::ranges::upper_bound(recording.ticks, time - reading_time, {}, &Tick::time);
    for (auto row = since; row != recording.ticks.end() && row->time <= time; ++row) {
        flags.faults |= row->faults;
        flags.statuses |= row->status;
    }
    return flags;
}

Eigen::Vector3d rendered_force(const Tick& tick) {
    return vector_of(tick.force);
}

std::vector<Eigen::Vector2d> force_columns(const RecordedTrack& track, std::size_t columns,
                                           const FeltForce& felt) {
    const double begins = track.front()->time, whole = track.back()->time - begins;
    std::vector<Eigen::Vector2d> ranges(columns);
    auto tick = track.begin();
    double held = felt(*track.front()).norm();
    for (std::size_t column = 0; column < columns; ++column) {
        const double until = begins + whole * static_cast<double>(column + 1) / static_cast<double>(columns);
        const bool last = column + 1 == columns;
        Eigen::Vector2d range(held, held);
        for (bool first = true; tick != track.end() && (last || (*tick)->time < until); ++tick) {
            held = felt(**tick).norm();
            range = first ? Eigen::Vector2d(held, held)
                          : Eigen::Vector2d(std::min(range[0], held), std::max(range[1], held));
            first = false;
        }
        ranges[column] = range;
    }
    return ranges;
}

double Demonstration::around(double time) const {
    const double whole = ends - begins;
    return whole > 0 ? begins + std::fmod(time, whole) : begins;
}

Demonstration demonstration_of(const RecordedTrack& track) {
    constexpr double margin = 1;  // s
    const auto touches = [](const Tick* tick) { return tick->contact_count > 0; };
    const double begins = track.front()->time, ends = track.back()->time;
    const auto first = std::ranges::find_if(track, touches);
    if (first == track.end()) return {begins, ends};
    const auto last = std::find_if(track.rbegin(), track.rend(), touches);
    return {std::max(begins, (*first)->time - margin), std::min(ends, (*last)->time + margin)};
}

void check_contacts(const Recording& recording, const Case& patient_case, const std::filesystem::path& file) {
    std::vector<std::int32_t> vertex_counts;
    const std::size_t bodies = patient_case.rigid_bodies.size() + patient_case.deformable_bodies.size();
    for (std::size_t body = 0; body < bodies; ++body)
        vertex_counts.push_back(static_cast<std::int32_t>(surface_of(patient_case, body).vertices.size()));
    const auto is_vertex = [&](std::int32_t body, std::int32_t vertex) {
        return vertex >= 0 && vertex < vertex_counts[body];
    };
    const auto finite = [](std::span<const float> values) {
        return std::ranges::all_of(values, [](float value) { return std::isfinite(value); });
    };
    const auto is_body = [&](std::int32_t body) { return body >= 0 && body < std::ssize(vertex_counts); };
    for (const Contact& contact : recording.contacts) {
        bool sound = is_body(contact.body) && finite(contact.weights) && finite(contact.normal) &&
                     finite(contact.friction) && std::isfinite(contact.force);
        for (const std::int32_t vertex : contact.vertices)
            sound = sound && (vertex == -1 || is_vertex(contact.body, vertex));
        if (is_of_neighbour(contact))
            sound =
                sound && is_body(contact.other_body) && is_vertex(contact.other_body, contact.other_vertex);
        if (!sound)
            throw InvalidInput({file.string(),
                                "a contact is of no vertex of case '" + patient_case.name + "'",
                                "bodies and vertices that the asset has", "the recording is damaged"});
    }
}

}  // namespace palpate::session
