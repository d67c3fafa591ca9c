// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "formats/model/disjoint_sets.hpp"
#include "formats/model/triangle_mesh.hpp"

namespace palpate::meshing {

/// What of a surface hangs together through vertices: sets of vertices.
DisjointSets pieces_of(const TriangleMesh& surface);

}  // namespace palpate::meshing
