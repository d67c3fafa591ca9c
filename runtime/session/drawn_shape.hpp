// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "formats/model/body.hpp"
#include "runtime/haptics/drawn_creep.hpp"
#include "runtime/haptics/haptic_model.hpp"

namespace palpate::session {

/// The shape of a case's deformable bodies as a picture of a run shows it. For one thread; the model must
/// outlive it.
class DrawnShape {
  public:
    DrawnShape(const Case& patient_case, const haptics::HapticModel& model);

    /// Writes where the contacts of all tools' ticks take each body, one displacement (mm) for each surface
    /// vertex: HapticModel::surface_displacement(), and where the method lets tissue creep what the ticks
    /// followed before left behind. Beside a running tick; linear in the surfaces.
    void follow(std::span<const TickResult* const> ticks,
                std::span<std::vector<Eigen::Vector3f>> displacements);
    /// The same of one tool.
    void follow(const TickResult& tick, std::span<std::vector<Eigen::Vector3f>> displacements) {
        const TickResult* one = &tick;
        follow({&one, 1}, displacements);
    }

  private:
    const haptics::HapticModel& model_;
    std::vector<haptics::DrawnCreep> creep_;
    std::vector<Eigen::Vector3f> of_one_tool_;
};

}  // namespace palpate::session
