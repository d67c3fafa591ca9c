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
      fresh_(patient_case, false),
      shape_(fresh_),
      memory_(1e-3 * static_cast<double>(model.memory_ticks())) {
    for (const Tick& row : recording.ticks) tracks_[row.tool].push_back(&row);
    std::erase_if(tracks_, [](const RecordedTrack& track) { return track.empty(); });
}

void RecordedSurfaces::follow(double time, std::span<std::vector<Vector3f>> displacements) {
    ticks_.clear();
    for (const RecordedTrack& track : tracks_)
        ticks_.push_back(with_contacts(recording_, tick_at(track, time)));
    std::vector<const TickResult*> ticks;
    for (const TickResult& tick : ticks_) ticks.push_back(&tick);
    shape_.follow(model_, time, ticks, displacements);
    time_ = time;
    followed_ = true;
}

void RecordedSurfaces::at(double time, std::span<std::vector<Vector3f>> displacements) {
    constexpr double step = 1.0 / 30;      // s, as a window's frames are apart
    constexpr double most_steps = 200;     // of what is followed anew
    constexpr double longest_step = 0.25;  // s, of time that goes on: 4 times as fast, 16 frames a second
    const bool goes_on = memory_ == 0 || (followed_ && time >= time_ && time - time_ <= longest_step);
    if (!goes_on) {
        shape_ = fresh_;
        const double before = std::clamp(time - recording_.ticks.front().time, 0.0, memory_);
        const double steps = std::min(std::ceil(before / step), most_steps);
        for (double k = 0; k < steps; ++k) follow(time - before * (1 - k / steps), displacements);
    }
    follow(time, displacements);
}

}  // namespace palpate::session
