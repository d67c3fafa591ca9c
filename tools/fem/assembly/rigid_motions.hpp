// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <span>

#include "formats/model/tet_mesh.hpp"

namespace palpate::fem {

/// Throws InvalidInput if the mesh, held at `fixed_nodes` (ascending), could still move without strain,
/// naming what moves (place, size), how (freely, about a point, about a line with its direction) and the
/// remedy.
///
/// Tetrahedra that share faces move as one, and so do groups of them that share three nodes off a line; such
/// a piece is held if its fixed nodes, with the nodes that it shares with held pieces, are not on a line.
/// Pieces that hang together by a node or an edge only can rotate about it. What is left after that is held
/// only if the pieces lock each other, which the null space of their common rigid motions tells; a hundred
/// pieces or more are taken to move. The same for linear and quadratic tetrahedra: an edge's middle lies on
/// its line. Points within a millionth of a piece's size of a line count as on it. Cost: a sort of the faces.
void require_no_rigid_motion(const TetMesh& mesh, std::span<const std::int32_t> fixed_nodes);

}  // namespace palpate::fem
