// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <vector>
#include <vtkNew.h>
#include <vtkRenderWindow.h>

#include "formats/model/body.hpp"
#include "tools/report/pictures/colour_scale.hpp"
#include "tools/report/pictures/picture.hpp"

namespace palpate::report {

/// A direction from the scene to the eye, in P; the patient's head is up.
using ViewDirection = Eigen::Vector3d;

/// A picture of the scene, and where some points of it are seen.
struct SceneView {
    Picture picture;
    std::vector<Eigen::Vector2d> marks;  ///< pixels from the picture's upper left corner
    double mm_per_pixel = 0;             ///< of a view without perspective, else 0
};

/// A window off the screen in which pictures are drawn one after the other: shaders are compiled once for all
/// of them. Needs an X display (VirtualDisplay) that outlives it.
class PictureWindow {
  public:
    PictureWindow();
    vtkRenderWindow* get() const { return window_; }

  private:
    vtkNew<vtkRenderWindow> window_;
};

/// Draws all bodies once from each direction: rigid ones bone-coloured and translucent, deformable ones with
/// their regions.
std::vector<SceneView> scene_pictures(const PictureWindow& window, const Case& patient_case,
                                      const std::vector<ViewDirection>& directions);

/// Draws one deformable body close up, once from each direction: the contact surface in the colour of its
/// region and translucent, so that enclosed regions show, the surface that cannot be touched in grey, fixed
/// nodes as dark dots.
std::vector<SceneView> body_pictures(const PictureWindow& window, const DeformableBody& body,
                                     const std::vector<ViewDirection>& directions);

/// Draws a body as glass with some of its tetrahedra solid and red; marks are their centroids.
std::vector<SceneView> tetrahedra_pictures(const PictureWindow& window, const DeformableBody& body,
                                           const std::vector<std::size_t>& tetrahedra,
                                           const std::vector<ViewDirection>& directions);

/// Draws tetrahedra without perspective, once from each direction: their outer faces in the colours of their
/// regions, with their edges. With `cut` those in front of the middle of the mesh are left out, so that the
/// inside shows.
std::vector<SceneView> mesh_pictures(const PictureWindow& window, const TetMesh& mesh,
                                     const std::vector<ViewDirection>& directions, bool cut);

/// Draws a surface with a value per triangle in the scale's colours; the mark is `marked` (p_P).
std::vector<SceneView> coloured_pictures(const PictureWindow& window, const TriangleMesh& surface,
                                         const std::vector<double>& triangle_values, const ColourScale& scale,
                                         const Eigen::Vector3d& marked,
                                         const std::vector<ViewDirection>& directions);

}  // namespace palpate::report
