// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>
#include <vtkActor2D.h>
#include <vtkCallbackCommand.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>
#include <vtkTextActor.h>

#include "runtime/visual/playback/playback_view.hpp"
#include "runtime/visual/readings/force_columns.hpp"

namespace palpate::visual {

/// The band at the window's bottom that shows a recording's force over time and where its head is. Where it
/// is clicked and along which it is dragged, the head is sought; the scene beneath does not notice.
class Timeline {
  public:
    /// Takes mouse events before the interactor's other observers do.
    Timeline(vtkRenderer* renderer, vtkRenderWindowInteractor* interactor);
    Timeline(const Timeline&) = delete;
    Timeline& operator=(const Timeline&) = delete;

    /// Nothing is shown and no event taken without a view.
    void update(const std::optional<TimelineView>& view);
    /// The share of the recording's time, 0 ... 1, that was clicked last since the last call.
    std::optional<double> take_sought();

  private:
    void handle(unsigned long event);
    void lay_out();
    void draw_curve();

    vtkRenderer* renderer_;
    vtkRenderWindowInteractor* interactor_;
    vtkNew<vtkCallbackCommand> events_;
    vtkNew<vtkPoints> band_points_, curve_points_, head_points_;
    vtkNew<vtkActor2D> band_, curve_, head_;
    vtkNew<vtkTextActor> text_;
    std::vector<Eigen::Vector2d> forces_;  // N, as drawn
    std::array<int, 2> window_{0, 0};      // pixels, as drawn
    Box box_;                              // of the band
    bool shown_ = false, dragged_ = false;
    std::optional<double> sought_;
};

}  // namespace palpate::visual
