// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <vector>

#include "formats/model/triangle_mesh.hpp"
#include "runtime/collision/collision_surface.hpp"

namespace palpate::haptics {

/// A ball inside a surface that touches the triangles about a vertex.
struct InnerBall {
    Eigen::Vector3d inset = Eigen::Vector3d::Zero();  ///< from the vertex to the ball's centre, mm
    double radius = 0;                                ///< mm
};

/// Finds a ball for each vertex of a closed surface, mm, so that the hulls of the balls at each triangle's
/// corners make the same surface with round edges. A ball has three times the radius of the tool (mm)
/// or the length of two edges, and less where the body is thin or strongly bent: what it cuts off or adds is
/// a twentieth of an edge or less. `surface` is the mesh's own. O(n log n) in the mesh.
std::vector<InnerBall> inner_balls(const TriangleMesh& mesh, const collision::CollisionSurface& surface,
                                   double tool_radius);

}  // namespace palpate::haptics
