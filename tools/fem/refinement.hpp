// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "formats/model/tet_mesh.hpp"

namespace palpate {

/// Halves every edge: each tetrahedron becomes eight of an eighth of its volume, four at its corners and four
/// around the shortest diagonal of the octahedron that remains. Nodes keep their numbers, and the middle of
/// an edge gets the number it has in discretise(mesh, ElementOrder::quadratic, ...); so that function's
/// fixed_nodes are those of the refined body. The eight parts of tetrahedron t are 8t ... 8t + 7 and inherit
/// its region. The middle of an edge of the outer boundary gets the lower of its ends' outside_labels, so
/// that between held and free tissue it counts as free where the background has the lower value, as it does;
/// a middle inside the body gets -1. Throws InvalidInput for a tetrahedron that require_sound_tetrahedra
/// refuses. Source: Bey 1995 (regular refinement), Zhang 1995 (shortest diagonal).
TetMesh refine_uniformly(const TetMesh& mesh);

}  // namespace palpate
