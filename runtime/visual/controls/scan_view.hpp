// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <span>
#include <vtkActor.h>
#include <vtkNew.h>
#include <vtkRenderer.h>
#include <vtkTextActor.h>

#include "runtime/visual/cut/cut_faces.hpp"
#include "runtime/visual/readings/colour_scale.hpp"
#include "runtime/visual/scan/scan_slices.hpp"

namespace palpate::visual {

/// What the window shows of a case's scan: a slice through the tool when it is asked for, the faces of a cut,
/// and what their greys mean, in HU of a CT.
class ScanView {
  public:
    /// `bodies` are those that a cut opens; `front` is drawn over `renderer` and has the slice's name.
    ScanView(const Scan& scan, std::span<vtkActor* const> bodies, vtkRenderer* renderer, vtkRenderer* front);

    /// The next slice, or none after the last.
    void turn() { slices_.turn(); }
    bool shows_slice() const { return !slices_.text().empty(); }
    /// Follows tool (p_P, mm) and camera, whose clipping range must be set. `cut`: the near plane is a cut's.
    void follow(const Eigen::Vector3d& tool, bool cut);
    /// Instead of follow(): takes slice and painted faces away, where something is to be found without.
    void hide();

  private:
    void tell(bool cut);

    vtkRenderer *renderer_, *front_;
    ScanImage image_;
    ScanSlices slices_;
    CutFaces faces_;
    ColourScale scale_;
    vtkNew<vtkTextActor> text_;
};

}  // namespace palpate::visual
