// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <chrono>
#include <optional>
#include <vector>
#include <vtkActor2D.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkRenderer.h>
#include <vtkTextActor.h>

#include "runtime/visual/readings/force_columns.hpp"

namespace palpate::visual {

/// The force of the last seconds as a curve that runs to the left, and beside it the largest and how long
/// that is.
class ForceStrip {
  public:
    using Time = std::chrono::steady_clock::time_point;

    explicit ForceStrip(vtkRenderer* renderer);

    /// Takes the least and the largest force (N) since the last call, at `now`.
    void add(Time now, const Eigen::Vector2d& range);
    /// Lies there from now on; `font`: pixels, of what is written.
    void place(const Box& box, int font);
    void show(bool on);
    /// What is drawn: the least and the largest force (N) of each tenth of a second, the latest last.
    const std::vector<Eigen::Vector2d>& columns() const { return columns_; }

  private:
    void draw();

    std::vector<Eigen::Vector2d> columns_;
    Eigen::Vector2d latest_ = Eigen::Vector2d::Zero();  // of the tenth of a second that goes on
    std::optional<Time> began_;                         // it did
    Box box_;
    vtkNew<vtkPoints> sheet_points_, curve_points_;
    vtkNew<vtkActor2D> sheet_, curve_;
    vtkNew<vtkTextActor> scale_;
};

}  // namespace palpate::visual
