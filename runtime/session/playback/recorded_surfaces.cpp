// SPDX-License-Identifier: Apache-2.0
#include "runtime/session/playback/recorded_surfaces.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::session {

using Eigen::Vector3f;

RecordedSurfaces::RecordedSurfaces(const recording::Recording& recording, const haptics::HapticModel& model,
                                   const Case& patient_case)
    : recording_(recording),
      model_(model),
      tracks_(recording.head.devices.size()),
      memory_(1e-3 * static_cast<double>(model.memory_ticks())) {
    for (const Tick& row : recording.ticks) tracks_[row.tool].push_back(&row);
    std::erase_if(tracks_, [](const RecordedTrack& track) { return track.empty(); });
    if (memory_ > 0)
        for (const DeformableBody& body : patient_case.deformable_bodies) fresh_.emplace_back(body);
}

void RecordedSurfaces::displace(double time, std::span<std::vector<Vector3f>> displacements) {
    for (std::size_t i = 0; i < displacements.size(); ++i) {
        std::ranges::fill(displacements[i], Vector3f::Zero());
        of_one_tool_.resize(displacements[i].size());
        for (const RecordedTrack& track : tracks_) {
            const Tick& tick = tick_at(track, time);
            if (tick.contact_count == 0) continue;
            model_.surface_displacement(model_.rigid_count() + i, with_contacts(recording_, tick),
                                        of_one_tool_);
            for (std::size_t v = 0; v < of_one_tool_.size(); ++v) displacements[i][v] += of_one_tool_[v];
        }
    }
}

void RecordedSurfaces::follow(double time, std::span<std::vector<Vector3f>> displacements) {
    displace(time, displacements);
    for (std::size_t i = 0; i < creep_.size(); ++i) creep_[i].follow(time, displacements[i]);
    time_ = time;
    followed_ = true;
}

void RecordedSurfaces::at(double time, std::span<std::vector<Vector3f>> displacements) {
    constexpr double step = 1.0 / 30;      // s, as a window's frames are apart
    constexpr double most_steps = 200;     // of what is followed anew
    constexpr double longest_step = 0.25;  // s, of time that goes on: 4 times as fast, 16 frames a second
    if (fresh_.empty()) return displace(time, displacements);
    const bool goes_on = followed_ && time >= time_ && time - time_ <= longest_step;
    if (!goes_on) {
        creep_ = fresh_;
        const double before = std::clamp(time - recording_.ticks.front().time, 0.0, memory_);
        const double steps = std::min(std::ceil(before / step), most_steps);
        for (double k = 0; k < steps; ++k) follow(time - before * (1 - k / steps), displacements);
    }
    follow(time, displacements);
}

}  // namespace palpate::session
