// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "formats/model/tet_mesh.hpp"
#include "formats/model/triangle_mesh.hpp"

namespace palpate {

/// Whether each edge is passed as often one way as the other, as of closed surfaces whose triangles agree
/// about their sides. By a sum of numbers that are drawn anew in each program, so that a surface where it is
/// not so is taken for one with a chance of 2^-64, and in time O(triangles) without sorting.
bool edges_cancel(const TriangleMesh& surface);

/// Likewise, whether each face within a mesh is of two tetrahedra, one on either side, and each other face
/// one of the boundary's: no tetrahedron is there twice. `boundary` is boundary_surface(mesh).
bool faces_cancel(const TetMesh& mesh, const BoundarySurface& boundary);

/// mm³ within a closed surface; negative if it faces inwards.
double enclosed_volume(const TriangleMesh& surface);

}  // namespace palpate
