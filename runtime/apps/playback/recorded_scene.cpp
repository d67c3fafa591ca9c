// SPDX-License-Identifier: Apache-2.0
#include "runtime/apps/playback/recorded_scene.hpp"

#include <algorithm>
#include <optional>

#include "formats/model/arrays.hpp"
#include "runtime/apps/first_sight.hpp"
#include "runtime/session/touch_target.hpp"

namespace palpate::apps {

using namespace session;

visual::OtherTool other_tool_of(const Tick& tick) {
    return {.position = vector_of(tick.tool_position),
            .shaft = vector_of(tick.shaft),
            .force = vector_of(tick.force)};
}

visual::OtherTool other_jaw_of(const Tick& tick) {
    visual::OtherTool jaw = other_tool_of(tick);
    jaw.force.setZero();
    jaw.kind = visual::OtherTool::Kind::jaw;
    return jaw;
}

RecordedScene::RecordedScene(const recording::Recording& recording, const std::filesystem::path& file,
                             std::int32_t tool, const haptics::HapticModel& model, const Case& patient_case)
    : recording_(recording),
      model_(model),
      case_(patient_case),
      track_(track_of(recording, tool, file)),
      surfaces_(recording, model, patient_case) {
    check_contacts(recording, patient_case, file);
    std::vector<RecordedTrack> tracks(recording.head.devices.size());
    for (const Tick& row : recording.ticks)
        if (row.tool != tool) tracks[row.tool].push_back(&row);
    std::ranges::copy_if(tracks, std::back_inserter(others_),
                         [](const auto& track) { return !track.empty(); });
}

visual::Sight RecordedScene::sight() const {
    for (const Tick* tick : track_) {
        const auto contacts = recording_.contacts_of(*tick);
        if (contacts.empty()) continue;
        const Contact& contact = contacts.front();
        const TriangleMesh& surface = surface_of(case_, contact.body);
        Eigen::Vector3d point = Eigen::Vector3d::Zero();
        for (std::size_t i = 0; i < 3 && contact.vertices[i] >= 0; ++i)
            point += static_cast<double>(contact.weights[i]) * surface.vertices[contact.vertices[i]];
        return first_sight(case_, model_, point, normal_of(contact));
    }
    const auto place = choose_touch_target(case_, model_, "", std::nullopt).place;
    return first_sight(case_, model_, place.point, place.normal);
}

Eigen::Vector3d RecordedScene::felt(const Tick& tick) const {
    Eigen::Vector3d force = vector_of(tick.force);
    if (recording_.head.jaws && !others_.empty())
        force += vector_of(tick_at(others_.front(), tick.time).force);
    return force;
}

const Tick& RecordedScene::fill(visual::VisualFrame& frame, double time) {
    const Tick& tick = tick_at(track_, time);
    frame.device_position = vector_of(tick.device_position);
    frame.tool_position = vector_of(tick.tool_position);
    frame.shaft = vector_of(tick.shaft);
    frame.tool_orientation = quaternion_of(tick.tool_orientation);
    frame.force = felt(tick);
    frame.torque = vector_of(tick.torque);
    frame.device = recording_.head.devices[static_cast<std::size_t>(tick.tool)].name;
    frame.depth = tick.depth;
    frame.overruns = tick.overruns;
    frame.tick_rate_hz = tick_rate_at(track_, time);
    const RecentFlags flags = flags_until(recording_, time);
    frame.faults = flags.faults;
    frame.statuses = flags.statuses;
    surfaces_.at(time, frame.displacements);
    frame.other_tools.clear();
    for (const RecordedTrack& other : others_) {
        const Tick& beside = tick_at(other, time);
        frame.other_tools.push_back(recording_.head.jaws ? other_jaw_of(beside) : other_tool_of(beside));
    }
    return tick;
}

}  // namespace palpate::apps
