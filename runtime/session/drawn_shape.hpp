// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "formats/model/body.hpp"
#include "runtime/haptics/drawn_creep.hpp"
#include "runtime/haptics/haptic_model.hpp"

namespace palpate::session {

/// The shape of a case's deformable bodies as a picture of a run shows it. For one thread.
class DrawnShape {
  public:
    /// `deforms_far`: with the shape of large deformation that the model has just then; a recording does not
    /// have it.
    explicit DrawnShape(const Case& patient_case, bool deforms_far = true);

    /// Writes where the contacts of all tools' ticks take each body at `time` (s), one displacement (mm) for
    /// each surface vertex: HapticModel::surface_displacement(), and where the model's method lets tissue
    /// creep what the ticks followed before left behind. `model` is that of the ticks, beside which it may
    /// go on ticking. Linear in the surfaces for each tool.
    void follow(const haptics::HapticModel& model, double time, std::span<const TickResult* const> ticks,
                std::span<std::vector<Eigen::Vector3f>> displacements);

  private:
    bool deforms_far_;
    std::vector<haptics::DrawnCreep> creep_;  // by body
    std::vector<Eigen::Vector3f> of_one_tool_;
};

}  // namespace palpate::session
