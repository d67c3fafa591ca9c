// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "formats/model/tet_mesh.hpp"

namespace palpate::meshing {

/// One face of one tetrahedron.
struct TetFace {
    Triangle sorted_nodes;
    std::size_t tet;
    std::size_t face;  ///< which of tetrahedron_faces
};

/// All faces of all tetrahedra, sorted by nodes, so that the two sides of an inner face are neighbours.
std::vector<TetFace> sorted_faces(const TetMesh& mesh);

/// A face with different regions on its two sides, seen from `inner`; `outer` is 0 on the boundary.
struct InterfaceFace {
    Triangle nodes;  ///< counter-clockwise seen from the outer side
    std::int32_t inner, outer;
};

/// All such faces of a mesh, each once.
std::vector<InterfaceFace> interface_faces(const TetMesh& mesh);

}  // namespace palpate::meshing
