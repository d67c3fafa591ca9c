// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <optional>
#include <vtkCamera.h>
#include <vtkNew.h>

namespace palpate::visual {

/// The view from the tool's tip: looks where the tool goes, or at what is due next. 90 degrees wide, as rigid
/// rhinoscopes are (70 to 120).
class Endoscope {
  public:
    bool on() const { return on_; }

    /// Begins with the camera's direction and keeps the camera as it is; turned off, puts it back.
    void turn(vtkCamera* camera);

    /// Puts the camera at the tip (p_P, mm). `look_at`: what is due, p_P, mm; without it the way that the tip
    /// has gone counts. Turns by and by, so that a trembling hand does not shake the picture.
    void follow(const Eigen::Vector3d& tip, const std::optional<Eigen::Vector3d>& look_at, double tool_radius,
                vtkCamera* camera);

  private:
    bool on_ = false;
    Eigen::Vector3d tip_ = Eigen::Vector3d::Zero(), forward_ = Eigen::Vector3d::Zero();
    bool placed_ = false;
    vtkNew<vtkCamera> before_;
};

}  // namespace palpate::visual
