// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <vector>
#include <vtkActor.h>
#include <vtkRenderer.h>

#include "runtime/visual/scan/scan_sampler.hpp"

namespace palpate::visual {

/// The scan on what a cut lays open. The cut is the camera's near plane, and where a soft body's far side is
/// seen through it, the eye's ray has entered the body there: the scan at that place of the near plane is
/// what lies in the cut. So far sides alone are painted, and near ones cost as much as without; a rigid
/// body's Section is such a far side. It does not follow what is pressed: the scan stays at rest.
class CutFaces {
  public:
    explicit CutFaces(const ScanImage& image);

    /// Paints the scan on an actor's far sides, faintly tinted by the colour that these have.
    void paint(vtkActor* actor);

    /// Takes the scan to the near plane of a renderer's camera; nothing of it is shown if `shown` is false,
    /// as where the eye is in a body. Samples anew where the view has changed.
    void follow(vtkRenderer* renderer, bool shown);

  private:
    ScanSampler sampler_;
    std::optional<ScanPlane> sampled_;
    std::vector<vtkActor*> actors_;
};

}  // namespace palpate::visual
