// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "formats/model/triangle_mesh.hpp"

namespace palpate::visual {

/// Reduces a surface to at most `budget` triangles, for the eye only: the haptic side keeps the whole
/// surface. Detail is spent where the eye will be: vertices are merged within cells whose edge grows with the
/// distance from `focus`, a line through one point or more (p_P, mm), so that the surface is whole near it
/// and coarse far away, without cracks between; within `near` (mm) it does not grow. Thin walls far away may
/// close. A surface within the budget comes back as it is. Throws InvalidInput for a budget below 1. Cost:
/// 0.1 s for 536 000 triangles. Source: vertex clustering, Rossignac and Borrel 1993.
TriangleMesh display_copy(const TriangleMesh& surface, std::int64_t budget,
                          const std::vector<Eigen::Vector3d>& focus, double near);

}  // namespace palpate::visual
