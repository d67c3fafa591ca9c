// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/measures/tet_faces.hpp"

#include <algorithm>

namespace palpate::meshing {

std::vector<TetFace> sorted_faces(const TetMesh& mesh) {
    std::vector<TetFace> faces;
    faces.reserve(4 * mesh.tetrahedra.size());
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        for (std::size_t f = 0; f < 4; ++f) {
            const Tetrahedron& tet = mesh.tetrahedra[t];
            Triangle nodes{tet[tetrahedron_faces[f][0]], tet[tetrahedron_faces[f][1]],
                           tet[tetrahedron_faces[f][2]]};
            std::ranges::sort(nodes);
            faces.push_back({nodes, t, f});
        }
    std::ranges::sort(faces, [](const TetFace& a, const TetFace& b) {
        return a.sorted_nodes != b.sorted_nodes ? a.sorted_nodes < b.sorted_nodes : a.tet < b.tet;
    });
    return faces;
}

std::vector<InterfaceFace> interface_faces(const TetMesh& mesh) {
    std::vector<InterfaceFace> result;
    const std::vector<TetFace> faces = sorted_faces(mesh);
    for (std::size_t i = 0; i < faces.size();) {
        const bool shared = i + 1 < faces.size() && faces[i + 1].sorted_nodes == faces[i].sorted_nodes;
        const std::int32_t inner = mesh.regions[faces[i].tet];
        const std::int32_t outer = shared ? mesh.regions[faces[i + 1].tet] : 0;
        if (inner != outer) {
            const Tetrahedron& tet = mesh.tetrahedra[faces[i].tet];
            const auto& corner = tetrahedron_faces[faces[i].face];
            result.push_back({{tet[corner[0]], tet[corner[1]], tet[corner[2]]}, inner, outer});
        }
        i += shared ? 2 : 1;
    }
    return result;
}

}  // namespace palpate::meshing
