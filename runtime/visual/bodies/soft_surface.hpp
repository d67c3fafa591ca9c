// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <vector>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include "formats/model/body.hpp"
#include "runtime/visual/bodies/moving_surface.hpp"
#include "runtime/visual/readings/stiffness_map.hpp"

namespace palpate::visual {

/// A deformable body as the eye sees it: its surface moves with the displacements. It looks like its largest
/// region throughout: what it encloses is to be found by touch.
class SoftSurface {
  public:
    /// `grain`: as of grained_tissue_actor().
    SoftSurface(const DeformableBody& body, const Eigen::Vector3d& toward_eye, double grain,
                const StiffnessMap& map, vtkRenderer* renderer);

    /// Moves the surface; one displacement (mm) per surface vertex.
    void deform(const std::vector<Eigen::Vector3f>& displacements) { surface_.displace(displacements); }

    /// Draws the finest spots and their relief, or leaves them out.
    void show_grain(bool on);
    /// Draws it in the map's colours where that knows it, or as tissue.
    void show_stiffness(bool on);
    /// Whether a cut may show the body from inside.
    void show_inside(bool on);
    /// All that ever draw it.
    std::vector<vtkActor*> actors() const;

  private:
    void choose();

    MovingSurface surface_;
    bool grain_shown_ = true, stiffness_shown_ = false;
    vtkSmartPointer<vtkActor> grained_, plain_, mapped_;  // of the same data; one is shown
};

}  // namespace palpate::visual
