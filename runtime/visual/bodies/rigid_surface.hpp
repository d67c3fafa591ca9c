// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vtkActor.h>
#include <vtkPolyData.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include "formats/model/body.hpp"
#include "runtime/visual/sight.hpp"

namespace palpate::visual {

/// A rigid body as the eye sees it: a copy of at most `budget` triangles, finest where the sight looks
/// closely.
class RigidSurface {
  public:
    RigidSurface(const RigidBody& body, const Sight& sight, std::int64_t budget, vtkRenderer* renderer);

    void show(bool on) { actor_->SetVisibility(on); }
    /// Draws that copy, or one of a quarter of it, which is made when it is first asked for.
    void show_fine(bool on);
    /// Whether a cut may show the body from inside.
    void show_inside(bool on);
    vtkActor* actor() const { return actor_; }

  private:
    Sight sight_;
    TriangleMesh copy_;
    vtkSmartPointer<vtkPolyData> fine_, coarse_;
    vtkSmartPointer<vtkActor> actor_;
};

}  // namespace palpate::visual
