// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vtkActor2D.h>
#include <vtkPoints.h>

namespace palpate::visual {

/// A rectangle of the window, pixels.
struct Box {
    double left = 0, bottom = 0, width = 1, height = 1;

    bool operator==(const Box&) const = default;
};

/// Draws a force over time into `box`, by an actor of make_quads(): a column from the least to the largest
/// force (N) of each of `forces`, and up to the next one's, so that a line is whole. `top`: the force at the
/// box's upper edge, N.
void draw_columns(vtkActor2D* actor, vtkPoints* points, std::span<const Eigen::Vector2d> forces, double top,
                  const Box& box);

}  // namespace palpate::visual
