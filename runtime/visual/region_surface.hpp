// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>

#include "formats/model/tet_mesh.hpp"

namespace palpate::visual {

/// The closed surface of a region at rest, oriented outwards, with the mesh node of each vertex, ascending:
/// faces of its tetrahedra that no other tetrahedron of it shares. Empty for a region without tetrahedra.
/// n log n in the region's tetrahedra.
BoundarySurface region_surface(const TetMesh& mesh, std::int32_t region);

}  // namespace palpate::visual
