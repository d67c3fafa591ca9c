// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <vtkActor.h>
#include <vtkImageData.h>
#include <vtkPoints.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include "formats/model/triangle_mesh.hpp"
#include "runtime/visual/scan/scan_plane.hpp"
#include "runtime/visual/tissue/tissue_colours.hpp"

namespace palpate::visual {

/// What a cut lays open of a rigid body: a rectangle just behind the camera's near plane, drawn where that
/// runs within the body's whole surface, however coarse the copy is that is drawn of it. It counts as a far
/// side, see CutFaces.
class Section {
  public:
    /// `surface` is closed and outlives it.
    Section(const TriangleMesh& surface, const TissueLook& look, vtkRenderer* renderer);

    /// Takes it to the near plane of the renderer's camera, or away. Linear in triangles where the view has
    /// changed.
    void follow(vtkRenderer* renderer, bool shown);
    vtkActor* actor() const { return actor_; }

  private:
    void place(const ScanPlane& plane, const Eigen::Vector3d& eye);
    void mark(const ScanPlane& plane, int columns);

    const TriangleMesh* surface_;
    std::optional<ScanPlane> marked_;
    bool cuts_ = false;  // the body, there
    vtkSmartPointer<vtkPoints> corners_;
    vtkSmartPointer<vtkImageData> marks_;
    vtkSmartPointer<vtkActor> actor_;
};

}  // namespace palpate::visual
