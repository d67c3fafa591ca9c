// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vtkActor.h>
#include <vtkLookupTable.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include "formats/model/body.hpp"
#include "runtime/visual/readings/colour_scale.hpp"

namespace palpate::visual {

/// The colours in which surfaces show how stiff they are under the case's tool (Feel::stiffness), one scale
/// for all bodies of a case, and that scale with its figures, hidden at first. It goes from the 5th to the
/// 95th percentile of what can be pressed; what cannot is grey.
class StiffnessMap {
  public:
    StiffnessMap(const Case& patient_case, vtkRenderer* front);

    /// Nobody has computed how stiff any body feels.
    bool empty() const { return empty_; }
    /// Draws `data`, whose points are the body's surface vertices, in these colours; null of a body of which
    /// nobody knows. Adds an array to the points of `data`.
    vtkSmartPointer<vtkActor> actor_of(const DeformableBody& body, vtkPolyData* data) const;
    /// Shows the scale.
    void show(bool on) { scale_.show(on); }
    /// Sizes follow the window.
    void fit() { scale_.fit(); }

  private:
    bool empty_ = true;
    vtkNew<vtkLookupTable> colours_;
    ColourScale scale_;
};

}  // namespace palpate::visual
