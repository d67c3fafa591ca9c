// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "formats/model/body.hpp"
#include "runtime/haptics/drawn_creep.hpp"
#include "runtime/haptics/haptic_model.hpp"
#include "runtime/session/playback/recorded_track.hpp"

namespace palpate::session {

/// The deformed surfaces of a recorded run at any moment. Recording and model must outlive it; the contacts
/// must be the case's own: check_contacts().
class RecordedSurfaces {
  public:
    /// `model` as model_of() makes it.
    RecordedSurfaces(const recording::Recording& recording, const haptics::HapticModel& model,
                     const Case& patient_case);

    /// Writes the displacement (mm) of every surface vertex of every deformable body at `time` (s): what the
    /// contacts of all tools make, HapticModel::surface_displacement(), and what earlier ones left behind
    /// where tissue creeps. Where time goes back or jumps, the latter is followed anew, from as long before
    /// as the tissue remembers, in 200 steps at most. Cost: surface_displacement() for each tool and step.
    void at(double time, std::span<std::vector<Eigen::Vector3f>> displacements);

  private:
    void displace(double time, std::span<std::vector<Eigen::Vector3f>> displacements);
    void follow(double time, std::span<std::vector<Eigen::Vector3f>> displacements);

    const recording::Recording& recording_;
    const haptics::HapticModel& model_;
    std::vector<RecordedTrack> tracks_;               // of the tools that have one
    std::vector<haptics::DrawnCreep> fresh_, creep_;  // by body; empty where nothing creeps
    double memory_;                                   // s
    double time_ = 0;
    bool followed_ = false;
    std::vector<Eigen::Vector3f> of_one_tool_;
};

}  // namespace palpate::session
