// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include "formats/model/tet_mesh.hpp"

namespace palpate {

/// Thinnest tetrahedron that an element can be made of, as 6 sqrt(2) volume / (longest edge)³: 1 for a
/// regular tetrahedron, 0 for a flat one, negative inside out.
inline constexpr double smallest_element_quality = 1e-7;

/// Returns 6 sqrt(2) volume / (longest edge)³ of tetrahedron t.
double element_quality(const TetMesh& mesh, std::size_t t);

/// Throws InvalidInput for the first tetrahedron that is not above smallest_element_quality (coordinates that
/// are not numbers included), naming it, its nodes, its place and the remedy.
void require_sound_tetrahedra(const TetMesh& mesh);

}  // namespace palpate
