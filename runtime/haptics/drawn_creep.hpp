// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "runtime/haptics/contact/creep.hpp"

namespace palpate::haptics {

/// The creep of a body as a picture of it needs it: follows the displacements that the contacts of some ticks
/// make (HapticModel::surface_displacement()) and adds what earlier ones left behind. A displacement counts
/// as if it had lasted since the one before. For one thread; linear in the surface.
class DrawnCreep {
  public:
    explicit DrawnCreep(const DeformableBody& body);

    /// `displacements` (mm), one for each surface vertex, of a tick at `time` (s). An earlier time than the
    /// last begins anew.
    void follow(double time, std::span<Eigen::Vector3f> displacements);

  private:
    SurfaceCreepSeries creep_;
    std::vector<std::vector<Eigen::Vector3f>> left_;  // by term and vertex, mm
    double last_time_ = 0;
};

}  // namespace palpate::haptics
