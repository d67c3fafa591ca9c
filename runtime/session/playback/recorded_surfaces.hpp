// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "formats/model/body.hpp"
#include "runtime/haptics/haptic_model.hpp"
#include "runtime/session/drawn_shape.hpp"
#include "runtime/session/playback/recorded_track.hpp"

namespace palpate::session {

/// The deformed surfaces of a recorded run at any moment. Recording and model must outlive it; the contacts
/// must be the case's own: check_contacts().
class RecordedSurfaces {
  public:
    /// `model` as model_of() makes it, or that of the run, which may go on ticking.
    RecordedSurfaces(const recording::Recording& recording, const haptics::HapticModel& model,
                     const Case& patient_case);

    /// Writes the displacement (mm) of every surface vertex of every deformable body at `time` (s): what the
    /// contacts of all tools make, HapticModel::surface_displacement(), and what earlier ones left behind
    /// where tissue creeps. Where time goes back or jumps, the latter is followed anew, from as long before
    /// as the tissue remembers, in 200 steps at most. Cost: surface_displacement() for each tool and step.
    void at(double time, std::span<std::vector<Eigen::Vector3f>> displacements);

  private:
    void follow(double time, std::span<std::vector<Eigen::Vector3f>> displacements);

    const recording::Recording& recording_;
    const haptics::HapticModel& model_;
    std::vector<RecordedTrack> tracks_;  // of the tools that have one
    DrawnShape fresh_, shape_;           // before anything was followed, and now
    double memory_;                      // s; 0 where nothing creeps
    double time_ = 0;
    bool followed_ = false;
    std::vector<TickResult> ticks_;  // that are shown
};

}  // namespace palpate::session
