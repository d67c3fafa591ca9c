// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/model/triangle_mesh.hpp"
#include "runtime/collision/collision_surface.hpp"

namespace palpate::haptics {

/// A ball inside a surface that touches the triangles about a vertex.
struct InnerBall {
    Eigen::Vector3d inset = Eigen::Vector3d::Zero();  ///< from the vertex to the ball's centre, mm
    double radius = 0;                                ///< mm

    /// How far it lies below the vertex, mm.
    double cut_off() const noexcept { return std::max(0.0, inset.norm() - radius); }
};

/// Finds a ball for each vertex of `mesh`, in its order, so that the hulls of the balls at each triangle's
/// corners make the same surface with round edges. A ball has three times the radius of the tool (mm) or the
/// length of two edges, and less where the body is thin or strongly bent, and none where it is held: it lies
/// a tenth of an edge below its vertex or above its triangles at most, and never more than 0.25 mm where
/// edges are blunt, 0.09 at a cube's and 0.05 where they are sharper. A vertex whose triangles have no area
/// has a ball of radius 0. The mesh is closed, its vertices are finite, mm, and its triangles look outward
/// (unchecked); `surface` is its own; `blocks` says which vertices give way, as compliance_blocks() does. A
/// ray by vertex and up to 200 passes over the triangles. Throws nothing but what allocating throws.
std::vector<InnerBall> inner_balls(const TriangleMesh& mesh, const collision::CollisionSurface& surface,
                                   std::span<const std::int32_t> blocks, double tool_radius);

}  // namespace palpate::haptics
