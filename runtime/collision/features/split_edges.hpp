// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>

#include "formats/model/triangle_mesh.hpp"

namespace palpate::collision {

/// The same surface with no edge longer than `longest` (mm, above 0): edges that are longer are halved, and
/// their triangles split so that neighbours still share whole edges, until none is or there would be more
/// than `most` triangles. Vertices of the mesh keep their places and their order, new ones follow.
TriangleMesh split_long_edges(const TriangleMesh& mesh, double longest, std::size_t most);

}  // namespace palpate::collision
