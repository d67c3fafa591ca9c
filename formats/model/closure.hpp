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

/// How often a closed surface winds about p: 1 inside and 0 outside of one that does not cut through itself.
/// The sum of the solid angles of all triangles (van Oosterom, Strackee 1983) over 4 pi.
double winding_number(const TriangleMesh& surface, const Eigen::Vector3d& p);

}  // namespace palpate
