// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "formats/model/tet_mesh.hpp"

namespace palpate {

/// The corners of the face opposite to each corner of a positively oriented tetrahedron, counter-clockwise
/// from outside.
inline constexpr std::array<std::array<std::size_t, 3>, 4> tet_faces{
    {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

/// One face of one tetrahedron.
struct TetFace {
    Triangle sorted_nodes;
    std::size_t tet;
    std::size_t face;  ///< which of tet_faces
};

/// All faces of all tetrahedra, sorted by nodes, so that the two sides of an inner face are neighbours.
std::vector<TetFace> sorted_faces(const TetMesh& mesh);

}  // namespace palpate
