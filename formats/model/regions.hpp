// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <string>
#include <vector>

#include "formats/model/tet_mesh.hpp"

namespace palpate {

/// The region of most volume: the organ, in which the others lie. The mesh must have a tetrahedron.
std::int32_t main_region(const TetMesh& mesh);

/// Its name in the mesh; "label 3" of one that has none.
std::string region_name(const TetMesh& mesh, std::int32_t region);

/// The labels of all other regions that occur, in the order of `mesh.region_names`.
std::vector<Label> enclosed_regions(const TetMesh& mesh);

/// The closed surface of a region, as boundary_surface() has that of the whole mesh: the faces that one of
/// its tetrahedra has alone. Empty for a region without tetrahedra.
BoundarySurface surface_of_region(const TetMesh& mesh, std::int32_t region);

/// The nodes of a region's tetrahedra, ascending.
std::vector<std::int32_t> nodes_of_region(const TetMesh& mesh, std::int32_t region);

}  // namespace palpate
