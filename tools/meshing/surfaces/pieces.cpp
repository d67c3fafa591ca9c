// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/surfaces/pieces.hpp"

namespace palpate::meshing {

DisjointSets pieces_of(const TriangleMesh& surface) {
    DisjointSets pieces(surface.vertices.size());
    for (const Triangle& t : surface.triangles)
        for (const std::int32_t v : {t[1], t[2]})
            pieces.join(static_cast<std::size_t>(t[0]), static_cast<std::size_t>(v));
    return pieces;
}

}  // namespace palpate::meshing
