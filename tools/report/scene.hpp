// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>

#include "formats/model/body.hpp"
#include "tools/report/picture.hpp"

namespace palpate {

/// From where a scene is seen and how large it is drawn.
struct SceneView {
    Eigen::Vector3d from = Eigen::Vector3d(-0.6, -1, 0.45);  ///< direction from the scene to the eye in P
    int width = 760;                                         ///< pixels
    int height = 620;
};

/// Draws all bodies: rigid ones bone-coloured and translucent, deformable ones with their regions. Needs an X
/// display (VirtualDisplay). About a second for 350 000 triangles in software.
Picture scene_picture(const Case& patient_case, const SceneView& view);

/// Draws one deformable body close up: the contact surface in the colour of its region and translucent, so
/// that enclosed regions show, the surface that cannot be touched in grey, fixed nodes as dark dots.
Picture body_picture(const DeformableBody& body, const SceneView& view);

}  // namespace palpate
