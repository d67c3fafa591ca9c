// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vtkActor.h>
#include <vtkPolyData.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include "formats/model/body.hpp"
#include "runtime/visual/cut/section.hpp"
#include "runtime/visual/sight.hpp"

namespace palpate::visual {

/// A rigid body as the eye sees it: a copy of at most `budget` triangles, finest where the sight looks
/// closely, and its section by a cut. The body outlives it.
class RigidSurface {
  public:
    RigidSurface(const RigidBody& body, const Sight& sight, std::int64_t budget, vtkRenderer* renderer);

    void show(bool on);
    /// Draws that copy, or one of a quarter of it, which is made when it is first asked for.
    void show_fine(bool on);
    /// Shows what the near plane of the renderer's camera cuts, or not.
    void follow_cut(vtkRenderer* renderer, bool cut) { section_.follow(renderer, cut && shown_); }
    vtkActor* actor() const { return actor_; }
    vtkActor* section() const { return section_.actor(); }

  private:
    Sight sight_;
    TriangleMesh copy_;
    vtkSmartPointer<vtkPolyData> fine_, coarse_;
    vtkSmartPointer<vtkActor> actor_;
    Section section_;
    bool shown_ = true;
};

}  // namespace palpate::visual
