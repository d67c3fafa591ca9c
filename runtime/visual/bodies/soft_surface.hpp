// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <vector>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include "formats/model/body.hpp"
#include "runtime/visual/bodies/moving_surface.hpp"

namespace palpate::visual {

/// A deformable body as the eye sees it: its surface moves with the displacements. It looks like its largest
/// region throughout: what it encloses is to be found by touch.
class SoftSurface {
  public:
    /// `grain`: as of grained_tissue_actor().
    SoftSurface(const DeformableBody& body, const Eigen::Vector3d& toward_eye, double grain,
                vtkRenderer* renderer);

    /// Moves the surface; one displacement (mm) per surface vertex.
    void deform(const std::vector<Eigen::Vector3f>& displacements) { surface_.displace(displacements); }

    /// As it is drawn now.
    vtkActor* actor() const { return grained_->GetVisibility() != 0 ? grained_ : plain_; }
    /// Draws the finest spots and their relief, or leaves them out.
    void show_grain(bool on);
    /// Whether a cut may show the body from inside.
    void show_inside(bool on);
    /// All that ever draw it.
    std::array<vtkActor*, 2> actors() const { return {grained_, plain_}; }

  private:
    MovingSurface surface_;
    vtkSmartPointer<vtkActor> grained_, plain_;  // of the same data; one is shown
};

}  // namespace palpate::visual
