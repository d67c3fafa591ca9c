// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <optional>
#include <span>
#include <vtkActor.h>
#include <vtkCamera.h>
#include <vtkLight.h>
#include <vtkNew.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkType.h>

#include "runtime/visual/inside/lens_shadow.hpp"

namespace palpate::visual {

/// Where an endoscope is and what it turns to.
struct ScopePose {
    Eigen::Vector3d tip = Eigen::Vector3d::Zero();    ///< p_P, mm
    Eigen::Vector3d shaft = Eigen::Vector3d::Zero();  ///< unit, from the tip along the tool; zero: not known
    Eigen::Quaterniond orientation{0, 0, 0, 0};       ///< R_PT of a tool that turns by itself, else zero
    std::optional<Eigen::Vector3d> look_at;           ///< p_P, mm
};

/// The view from the tool's tip: along its shaft if that is known, else at what it is to look at, else where
/// the tool goes; a tool that turns about its shaft turns the picture. 90 degrees wide, as rigid rhinoscopes
/// are (70 to 120), round, and lit from the tip alone, whose light grows fainter with distance. It fills the
/// window, or has a corner of it beside the view from outside; what a corner costs is paid while it is there.
class Endoscope {
  public:
    /// `outside` draws the scene in `window`. Off at first.
    Endoscope(vtkRenderWindow* window, vtkRenderer* outside);

    /// Whole window, corner, off, and on from there.
    void turn();
    void turn_off();
    bool fills_window() const { return place_ == Place::window; }
    bool on() const { return place_ != Place::nowhere; }
    /// Whether it has that pixel, `x` from the left, `y` from below.
    bool covers(int x, int y) const;

    /// Follows the tool, by and by, so that a trembling hand does not shake the picture. `seconds`: since the
    /// last picture; `hidden`: what of the scene the eye is in.
    void follow(const ScopePose& pose, double tool_radius, double seconds, std::span<vtkActor* const> hidden);

  private:
    enum class Place { nowhere, window, corner };
    void fill_window();
    void leave_window();
    void look_along(const ScopePose& pose, double seconds);
    void share_scene(std::span<vtkActor* const> hidden);
    void fit_corner();

    Place place_ = Place::nowhere;
    Eigen::Vector3d tip_ = Eigen::Vector3d::Zero(), forward_ = Eigen::Vector3d::Zero();
    Eigen::Vector3d up_in_tool_ = Eigen::Vector3d::Zero();
    bool placed_ = false;
    vtkRenderWindow* window_;
    vtkRenderer* outside_;
    vtkNew<vtkCamera> camera_;
    vtkNew<vtkLight> light_;
    vtkSmartPointer<vtkCamera> camera_outside_;  // while the window is the endoscope's, as the next
    Eigen::Vector3d background_ = Eigen::Vector3d::Zero();
    LensShadow window_lens_;
    vtkNew<vtkRenderer> corner_;
    LensShadow corner_lens_;
    vtkMTimeType shared_ = 0;  // the scene's, when corner_ got its actors
};

}  // namespace palpate::visual
