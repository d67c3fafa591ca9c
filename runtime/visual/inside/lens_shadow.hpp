// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <vtkActor2D.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkRenderer.h>

namespace palpate::visual {

/// What an endoscope's round lens leaves black: all of a renderer's picture but the largest circle in it,
/// whose edge is soft.
class LensShadow {
  public:
    /// Hidden at first.
    explicit LensShadow(vtkRenderer* renderer);

    void show(bool on) { actor_->SetVisibility(on); }
    /// Fits the circle into the renderer as large as it is now.
    void fit();

  private:
    vtkRenderer* renderer_;
    vtkNew<vtkPoints>
        points_;  // of three circles: where the shadow begins, where it is black, beyond all corners
    vtkNew<vtkActor2D> actor_;
    std::array<int, 2> size_{0, 0};  // pixels
};

}  // namespace palpate::visual
