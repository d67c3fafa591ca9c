// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>

#include "formats/model/tet_mesh.hpp"

namespace palpate::visual {

/// The closed surface of a region at rest, oriented outwards: faces of its tetrahedra that no other
/// tetrahedron of it shares. Empty for a region without tetrahedra. n log n in the region's tetrahedra.
TriangleMesh region_surface(const TetMesh& mesh, std::int32_t region);

}  // namespace palpate::visual
