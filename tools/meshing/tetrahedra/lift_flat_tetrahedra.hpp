// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "formats/model/tet_mesh.hpp"

namespace palpate::meshing {

/// Moves the nodes of flat tetrahedra, those with a dihedral angle below `bound_deg` or above 180° -
/// `bound_deg`, as long as that makes the flattest tetrahedron around the node less flat. Nodes inside a
/// region move freely; nodes on interfaces and on the boundary stay within `max_surface_move` mm of where
/// they were. Tetrahedra keep their nodes, and none becomes flatter than the flattest around; the
/// boundary stays without cuts. Deterministic.
void lift_flat_tetrahedra(TetMesh& mesh, double bound_deg, double max_surface_move);

}  // namespace palpate::meshing
