// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "formats/model/tet_mesh.hpp"

namespace palpate::elasticity {

/// Quality at or below which a tetrahedron makes no element. Solves lose digits as 1e-16 / quality (measured:
/// one interior element of a block squeezed onto a face, an edge or a corner), so this one leaves the 1e-10
/// that a certificate asks for. Sound but thin elements lie above: a sliver with dihedral angles of 1 degree
/// has 1e-2, a needle with 1 degree at its tip 4e-4, and none whose face and dihedral angles are all 1 degree
/// or more has less than 4e-6 (by numerical search).
inline constexpr double smallest_element_quality = 1e-6;

/// Returns 6 sqrt(2) volume / (longest edge)³ of tetrahedron t: 1 if regular, 0 if flat, negative if inside
/// out.
double element_quality(const TetMesh& mesh, std::size_t t);

/// Throws InvalidInput for the first tetrahedron that is not above smallest_element_quality (coordinates that
/// are not numbers included), naming it, its nodes, its place, its quality and the remedy.
void require_sound_tetrahedra(const TetMesh& mesh);

}  // namespace palpate::elasticity
