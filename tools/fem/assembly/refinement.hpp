// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "formats/model/tet_mesh.hpp"

namespace palpate::fem {

/// Halves every edge: each tetrahedron becomes eight of an eighth of its volume, four at its corners and four
/// around the shortest diagonal of the octahedron that remains. Nodes keep their numbers, and the middle of
/// an edge gets the number it has in discretise(mesh, ElementOrder::quadratic, ...), so the fixed_nodes of
/// that discretisation are those of the refined body. The parts of tetrahedron t are 8t ... 8t + 7, in its
/// region. In outside_labels the middle of an outer boundary's edge gets the lower label of both ends, so
/// that an edge between background (0) and a label counts as background; a middle inside the body gets -1.
/// Throws InvalidInput for a tetrahedron that require_sound_tetrahedra refuses. Cost: one discretisation.
/// Source: Bey 1995 (regular refinement), Zhang 1995 (shortest diagonal).
TetMesh refine_uniformly(const TetMesh& mesh);

}  // namespace palpate::fem
