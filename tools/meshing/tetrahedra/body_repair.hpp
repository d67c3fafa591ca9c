// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>

#include "formats/model/tet_mesh.hpp"

namespace palpate::meshing {

/// Doubles nodes where parts of a body meet in a point or an edge but in no face: such hinges carry no
/// elastic force that a refined mesh would show, and make the boundary non-manifold. Returns the number of
/// new nodes.
std::int64_t split_hinges(TetMesh& mesh);

/// Gives every island of a region (tetrahedra connected through faces) of less than `min_volume` mm³ to the
/// region that it shares most faces with, but never a region's largest. Returns the number of islands given
/// away.
std::int64_t absorb_islands(TetMesh& mesh, double min_volume);

/// Removes pieces (connected through faces) of less than `min_volume` mm³ and the nodes that only they use,
/// but never the piece that holds most of a region. Returns the number of pieces removed.
std::int64_t remove_crumbs(TetMesh& mesh, double min_volume);

/// Removes, at every edge that more than two faces of the boundary share, the smallest of the fans of
/// tetrahedra that meet there, until no such edge is left: two parts of a body closer than the mesh is fine.
/// Then calls split_hinges(). Returns the number of tetrahedra removed.
std::int64_t part_pinched_edges(TetMesh& mesh);

}  // namespace palpate::meshing
