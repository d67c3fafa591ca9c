// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <vector>

#include "formats/model/body.hpp"
#include "tools/report/picture.hpp"

namespace palpate {

/// A direction from the scene to the eye, in P; the patient's head is up.
using ViewDirection = Eigen::Vector3d;

/// Draws all bodies once from each direction: rigid ones bone-coloured and translucent, deformable ones with
/// their regions. Needs an X display (VirtualDisplay).
std::vector<Picture> scene_pictures(const Case& patient_case, const std::vector<ViewDirection>& directions);

/// Draws one deformable body close up, once from each direction: the contact surface in the colour of its
/// region and translucent, so that enclosed regions show, the surface that cannot be touched in grey, fixed
/// nodes as dark dots.
std::vector<Picture> body_pictures(const DeformableBody& body, const std::vector<ViewDirection>& directions);

}  // namespace palpate
